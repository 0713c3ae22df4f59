#include "calibrato/guide/wanted_accuracy.h"

#include <gtest/gtest.h>

#include <cmath>

#include "calibrato/base/input_error_testing.h"

namespace calibrato {
namespace {

TEST(SetWanted, TakesNamesWithTheirUnits) {
  WantedAccuracy wanted;
  SetWanted("focal-percent=0.1", &wanted);
  SetWanted("rotation-deg=1", &wanted);
  SetWanted("translation-mm=3", &wanted);
  SetWanted("time-ms=0.5", &wanted);
  EXPECT_DOUBLE_EQ(wanted.focal_share, 0.001);
  EXPECT_NEAR(wanted.rotation_rad, 0.0174532925, 1e-9);
  EXPECT_DOUBLE_EQ(wanted.translation_m, 0.003);
  EXPECT_DOUBLE_EQ(wanted.time_offset_s, 0.0005);
}

TEST(SetWanted, RefusesOthers) {
  WantedAccuracy wanted;
  for (const char* word : {"", "time-ms", "time-ms=", "time-ms=0", "time-ms=-1", "time-ms=nan",
                           "time-ms=inf", "time-ms=1x", "focus=1"}) {
    EXPECT_THROW(SetWanted(word, &wanted), InputError) << word;
  }
}

// Sigmas by hand: the inverse of a diagonal.
TEST(ProgressOf, NamesWhatIsWantedInItsOrder) {
  const CameraModel camera("pinhole-none", Eigen::Vector4d(500.0, 500.0, 320.0, 240.0));
  const KnowledgeLayout layout{true, 4};
  Eigen::VectorXd sigma(13);
  sigma << 1e-3, 2e-3, 3e-3, 0.01, 0.02, 0.03, 1e-4, 0.1, 0.1, 1.0, 2.0, 3.0, 4.0;
  const Eigen::MatrixXd information =
      sigma.array().square().inverse().matrix().asDiagonal().toDenseMatrix();
  const auto progress = ProgressOf(information, layout, camera, {});
  ASSERT_EQ(progress.size(), 11U);
  EXPECT_EQ(progress[0].name, "fu");
  EXPECT_NEAR(progress[3].sigma, 4.0, 1e-12);
  EXPECT_DOUBLE_EQ(progress[3].wanted, 0.002 * 500.0);
  EXPECT_EQ(progress[4].name, "rot_x");
  EXPECT_NEAR(progress[9].sigma, 0.03, 1e-12);
  EXPECT_EQ(progress[10].name, "time_offset");
  EXPECT_TRUE(progress[0].is_reached());
  EXPECT_FALSE(progress[3].is_reached());
}

TEST(DistanceFromWanted, CountsWhatIsNotReached) {
  const ParameterProgress far{"a", "m", std::exp(1.0), 1.0};
  const ParameterProgress reached{"b", "m", std::exp(-1.0), 1.0};
  EXPECT_NEAR(DistanceFromWanted({far}), 1.02, 1e-12);
  EXPECT_NEAR(DistanceFromWanted({far, reached}), 1.0, 1e-12);
}

}  // namespace
}  // namespace calibrato
