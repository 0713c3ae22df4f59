#pragma once

#include <compare>
#include <cstdint>
#include <string>

namespace calibrato {

/// A span of time [ns]. Exact; convert to seconds only at the end: (t1 - t0).seconds().
class Duration {
 public:
  constexpr Duration() = default;
  static constexpr Duration FromNanoseconds(int64_t nanoseconds) { return Duration(nanoseconds); }
  /// Rounded to the nearest nanosecond.
  /// @throws std::invalid_argument unless |seconds| < 9.2e9 (292 years); NaN is refused.
  static Duration FromSeconds(double seconds);

  constexpr int64_t nanoseconds() const { return nanoseconds_; }
  constexpr double seconds() const { return static_cast<double>(nanoseconds_) * 1e-9; }

  constexpr auto operator<=>(const Duration&) const = default;
  constexpr Duration operator+(Duration other) const {
    return Duration(nanoseconds_ + other.nanoseconds_);
  }
  constexpr Duration operator-(Duration other) const {
    return Duration(nanoseconds_ - other.nanoseconds_);
  }
  constexpr Duration operator-() const { return Duration(-nanoseconds_); }
  constexpr Duration operator*(int64_t factor) const { return Duration(nanoseconds_ * factor); }

 private:
  explicit constexpr Duration(int64_t nanoseconds) : nanoseconds_(nanoseconds) {}
  int64_t nanoseconds_ = 0;
};

/// A point in time [ns since the epoch of its clock]. Two clocks (camera, IMU) are never mixed
/// without their offset: t_i = t_c + time_offset_i_c.
class Time {
 public:
  constexpr Time() = default;
  static constexpr Time FromNanoseconds(int64_t nanoseconds) { return Time(nanoseconds); }

  constexpr int64_t nanoseconds() const { return nanoseconds_; }

  constexpr auto operator<=>(const Time&) const = default;
  constexpr Duration operator-(Time other) const {
    return Duration::FromNanoseconds(nanoseconds_ - other.nanoseconds_);
  }
  constexpr Time operator+(Duration d) const { return Time(nanoseconds_ + d.nanoseconds()); }
  constexpr Time operator-(Duration d) const { return Time(nanoseconds_ - d.nanoseconds()); }

 private:
  explicit constexpr Time(int64_t nanoseconds) : nanoseconds_(nanoseconds) {}
  int64_t nanoseconds_ = 0;
};

}  // namespace calibrato
