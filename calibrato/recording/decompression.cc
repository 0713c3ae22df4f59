#include "calibrato/recording/decompression.h"

#include <bzlib.h>
#include <lz4frame.h>
#include <zstd.h>

#include <algorithm>
#include <climits>
#include <functional>
#include <memory>

#include "calibrato/recording/byte_fields.h"

namespace calibrato {
namespace {

constexpr uint64_t kFirstBytes = uint64_t{1} << 20;

[[noreturn]] void Fail(const std::string& format, const std::string& why) {
  throw Damage{"a part that is packed by " + format + " " + why};
}

// How far one step of unpacking came.
struct Step {
  size_t num_in = 0;
  size_t num_out = 0;
  bool is_done = false;
};

// Unpacks by steps into a buffer that doubles, one byte beyond the size at most: enough to see that
// there is more.
std::string Unpack(const std::string& format, std::string_view packed, uint64_t size,
                   const std::function<Step(std::string_view in, char* out, size_t room)>& step) {
  std::string bytes;
  size_t num_bytes = 0;
  while (true) {
    if (num_bytes == bytes.size()) {
      if (num_bytes > size) Fail(format, "is larger than it claims");
      bytes.resize(std::min(size + 1, std::max(kFirstBytes, uint64_t{2} * bytes.size())));
    }
    const Step done = step(packed, bytes.data() + num_bytes, bytes.size() - num_bytes);
    packed.remove_prefix(done.num_in);
    num_bytes += done.num_out;
    if (done.is_done) break;
    if (done.num_in == 0 && done.num_out == 0) Fail(format, "is truncated");
  }
  if (num_bytes != size) {
    Fail(format, "has " + std::to_string(num_bytes) + " bytes and claims " + std::to_string(size));
  }
  bytes.resize(num_bytes);
  return bytes;
}

std::string UnpackBzip2(std::string_view packed, uint64_t size) {
  bz_stream stream{};
  if (BZ2_bzDecompressInit(&stream, 0, 0) != BZ_OK) throw std::bad_alloc();
  const std::unique_ptr<bz_stream, int (*)(bz_stream*)> owner(&stream, BZ2_bzDecompressEnd);
  return Unpack("bz2", packed, size, [&](std::string_view in, char* out, size_t room) -> Step {
    const size_t num_in = std::min<size_t>(in.size(), INT_MAX);
    const size_t num_out = std::min<size_t>(room, INT_MAX);
    stream.next_in = const_cast<char*>(in.data());  // bzip2 knows no const data
    stream.avail_in = static_cast<unsigned>(num_in);
    stream.next_out = out;
    stream.avail_out = static_cast<unsigned>(num_out);
    const int result = BZ2_bzDecompress(&stream);
    if (result != BZ_OK && result != BZ_STREAM_END) Fail("bz2", "is damaged");
    return {num_in - stream.avail_in, num_out - stream.avail_out, result == BZ_STREAM_END};
  });
}

std::string UnpackLz4(std::string_view packed, uint64_t size) {
  LZ4F_dctx* context = nullptr;
  if (LZ4F_isError(LZ4F_createDecompressionContext(&context, LZ4F_VERSION))) throw std::bad_alloc();
  const std::unique_ptr<LZ4F_dctx, LZ4F_errorCode_t (*)(LZ4F_dctx*)> owner(
      context, LZ4F_freeDecompressionContext);
  return Unpack("lz4", packed, size, [&](std::string_view in, char* out, size_t room) -> Step {
    size_t num_in = in.size();
    size_t num_out = room;
    const size_t hint = LZ4F_decompress(context, out, &num_out, in.data(), &num_in, nullptr);
    if (LZ4F_isError(hint)) Fail("lz4", "is damaged");
    return {num_in, num_out, hint == 0};
  });
}

std::string UnpackZstd(std::string_view packed, uint64_t size) {
  const std::unique_ptr<ZSTD_DCtx, size_t (*)(ZSTD_DCtx*)> context(ZSTD_createDCtx(),
                                                                   ZSTD_freeDCtx);
  if (!context) throw std::bad_alloc();
  // A frame may ask for a window of gigabytes: what fits into 2^23 bytes is what encoders use.
  constexpr int kMaxWindowLog = 23;
  ZSTD_DCtx_setParameter(context.get(), ZSTD_d_windowLogMax, kMaxWindowLog);
  return Unpack("zstd", packed, size, [&](std::string_view in, char* out, size_t room) -> Step {
    ZSTD_inBuffer input{in.data(), in.size(), 0};
    ZSTD_outBuffer output{out, room, 0};
    const size_t hint = ZSTD_decompressStream(context.get(), &output, &input);
    if (ZSTD_isError(hint)) Fail("zstd", "is damaged");
    return {input.pos, output.pos, hint == 0};
  });
}

}  // namespace

std::optional<Compression> CompressionFromName(std::string_view name) {
  if (name.empty() || name == "none") return Compression::kNone;
  if (name == "bz2") return Compression::kBzip2;
  if (name == "lz4") return Compression::kLz4;
  if (name == "zstd") return Compression::kZstd;
  return std::nullopt;
}

std::string Decompress(Compression compression, std::string_view packed, uint64_t size) {
  switch (compression) {
    case Compression::kNone:
      break;
    case Compression::kBzip2:
      return UnpackBzip2(packed, size);
    case Compression::kLz4:
      return UnpackLz4(packed, size);
    case Compression::kZstd:
      return UnpackZstd(packed, size);
  }
  if (packed.size() != size) {
    throw Damage{"a part has " + std::to_string(packed.size()) + " bytes and claims " +
                 std::to_string(size)};
  }
  return std::string(packed);
}

}  // namespace calibrato
