#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace calibrato {

/// How the parts of a bag may be packed. Private to the room, as what follows.
enum class Compression { kNone, kBzip2, kLz4, kZstd };

/// By the name that bags use: "" or "none", "bz2", "lz4", "zstd"; nothing for another.
[[nodiscard]] std::optional<Compression> CompressionFromName(std::string_view name);

/// Unpacks what must have exactly `size` bytes unpacked. lz4 is its frame format. Memory grows with
/// what there really is, not with what is claimed.
/// @throws Damage: damaged, truncated, or of another size.
[[nodiscard]] std::string Decompress(Compression compression, std::string_view packed,
                                     uint64_t size);

}  // namespace calibrato
