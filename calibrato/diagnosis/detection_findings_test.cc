#include "calibrato/diagnosis/detection_findings.h"

#include <gtest/gtest.h>

namespace calibrato {
namespace {

TEST(FindingsOnDetection, NameWhatTheOwnerCanMend) {
  RejectionCounts counts;
  counts.images_with_mirrored_board = 3;
  counts.tags_not_on_board = 2;
  const std::vector<Finding> findings = FindingsOnDetection(counts);
  ASSERT_EQ(findings.size(), 2U);
  EXPECT_EQ(findings[0].what, "3 images show the board mirrored");
  EXPECT_EQ(findings[1].what, "2 tags have numbers that the board has not");
  EXPECT_EQ(VerdictOf(findings), Verdict::kPass);
}

TEST(FindingsOnDetection, AreSilentAboutCornersThatEveryImageLoses) {
  RejectionCounts counts;
  counts.corners_near_border = 100;
  counts.corners_of_bad_fit = 5;
  EXPECT_TRUE(FindingsOnDetection(counts).empty());
}

}  // namespace
}  // namespace calibrato
