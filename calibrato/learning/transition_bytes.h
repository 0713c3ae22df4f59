#pragma once

#include "calibrato/learning/byte_stream.h"
#include "calibrato/learning/history.h"

namespace calibrato {

/// A transition as bytes: in checkpoints, and between processes.
void Write(const Transition& transition, ByteWriter& writer);
/// @throws InputError as ByteReader.
[[nodiscard]] Transition ReadTransition(ByteReader& reader);

}  // namespace calibrato
