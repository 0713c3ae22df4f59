#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace calibrato {

/// A random stream that its owner passes on by reference; nothing in calibrato draws from anywhere
/// else. The same seed gives the same numbers on every machine: the distributions are ours too,
/// since those of <random> differ between standard libraries.
///
/// The generator is xoshiro256++ (Blackman and Vigna, "Scrambled linear pseudorandom number
/// generators", ACM TOMS 2021), seeded by splitmix64.
class Rng {
 public:
  explicit Rng(uint64_t seed);

  /// An independent stream for (purpose, index), for example ("noise", episode). It depends on the
  /// seed that this stream was made with, not on how much was drawn from it: adding a draw in one
  /// place changes no other.
  [[nodiscard]] Rng Stream(std::string_view purpose, uint64_t index = 0) const;

  uint64_t NextBits();
  /// Uniform in [0, 1).
  double Uniform();
  /// Uniform in [low, high).
  double Uniform(double low, double high);
  /// Uniform in {0, .., n - 1}, without bias. @pre n > 0
  uint64_t UniformIndex(uint64_t n);
  /// Standard normal (Marsaglia's polar method).
  double Normal();
  double Normal(double mean, double stddev) { return mean + stddev * Normal(); }

  /// All there is to this stream, for checkpoints: Restore(state()) continues with the same draws.
  struct State {
    uint64_t seed = 0;
    std::array<uint64_t, 4> words{};
    double spare_normal = 0.0;
    bool has_spare_normal = false;
  };
  [[nodiscard]] State state() const { return state_; }
  void Restore(const State& state) { state_ = state; }

 private:
  State state_;
};

}  // namespace calibrato
