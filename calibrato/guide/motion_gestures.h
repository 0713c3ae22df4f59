#pragma once

#include <vector>

#include "calibrato/guide/gesture.h"
#include "calibrato/motion/motion.h"

namespace calibrato {

/// The loops of a motion that was made for a carrier, as gestures from where the hand's camera
/// stands, in their order. The camera goes as that of the paper's rig would (PaperRig), each loop
/// smaller by one factor, as far as it takes to keep the board in view and the hand within its
/// reach, and no faster than the hand is. A loop that would have to shrink to less than a fifth is
/// left out.
[[nodiscard]] std::vector<Gesture> GesturesOfMotion(const GestureSetting& setting,
                                                    const Motion& motion);

}  // namespace calibrato
