#include "calibrato/evaluation/paper_figures.h"

#include <map>

namespace calibrato {

std::optional<PaperFigures> FiguresOfPaper(Task task, const std::string& policy) {
  static const std::map<std::string, PaperFigures> kIntrinsic = {
      {"random", {0.560, 9.627, {}}},
      {"handcrafted", {0.196, 11.116, {}}},
      {"learned", {0.159, 11.037, {}}},
      {"reprojection", {0.155, 9.319, {}}}};
  static const std::map<std::string, PaperFigures> kExtrinsic = {
      {"random", {0.396, 7.331, 4.16e-8}},
      {"handcrafted", {0.340, 3.306, 1.97e-7}},
      {"learned", {0.265, 4.367, 5.83e-8}},
      {"fine-tuned", {0.214, 3.241, 9.83e-8}},
      {"reprojection", {0.268, 4.333, 8.39e-8}}};
  const auto& figures = task == Task::kIntrinsic ? kIntrinsic : kExtrinsic;
  const auto found = figures.find(policy);
  if (found == figures.end()) return std::nullopt;
  return found->second;
}

}  // namespace calibrato
