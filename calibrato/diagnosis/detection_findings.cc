#include "calibrato/diagnosis/detection_findings.h"

#include <string>

namespace calibrato {
namespace {

void Add(int count, const std::string& what, const std::string& remedy,
         std::vector<Finding>* findings) {
  if (count > 0) findings->push_back({Severity::kInfo, std::to_string(count) + " " + what, remedy});
}

}  // namespace

std::vector<Finding> FindingsOnDetection(const RejectionCounts& counts) {
  std::vector<Finding> findings;
  Add(counts.images_with_mirrored_board, "images show the board mirrored",
      "turn off the camera's mirror, or do not film the board in one", &findings);
  Add(counts.images_with_two_boards, "images show two such boards", "cover one of them", &findings);
  Add(counts.images_with_other_layout, "images show tags in another layout than the board's",
      "check the target file: are rows and columns swapped?", &findings);
  Add(counts.tags_not_on_board, "tags have numbers that the board has not",
      "check the target file's tagRows and tagCols", &findings);
  Add(counts.tags_of_another_family, "tags are of another family", "use a board of family tag36h11",
      &findings);
  Add(counts.tags_seen_twice, "tags were seen twice in one image and not taken",
      "cover the second board, or what reflects the first", &findings);
  return findings;
}

}  // namespace calibrato
