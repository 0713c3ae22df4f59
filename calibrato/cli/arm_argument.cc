#include "calibrato/cli/arm_argument.h"

#include <vector>

#include "calibrato/cli/parse.h"
#include "calibrato/motion/arm_file.h"

namespace calibrato {

void AddArmArgument(CLI::App& app, std::string* path) {
  app.add_option("--arm", *path,
                 "ARM.yaml: an arm of your own by its URDF, instead of the Panda (docs/arms.md)");
}

std::optional<Arm> ReadArmArgument(const std::string& path) {
  if (path.empty()) return std::nullopt;
  std::vector<std::string> warnings;
  Arm arm = ReadArm(path, &warnings);
  PrintWarnings(warnings);
  return arm;
}

RobotNames NamesOf(const Arm& arm) {
  RobotNames names{{}, arm.base_frame};
  for (const Arm::Joint& joint : arm.joints) names.joints.push_back(joint.name);
  return names;
}

}  // namespace calibrato
