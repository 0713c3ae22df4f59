#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>

#include "calibrato/motion/arm.h"
#include "calibrato/motion/robot_formats.h"

namespace calibrato {

/// Adds --arm.
void AddArmArgument(CLI::App& app, std::string* path);

/// The arm of ARM.yaml; nothing for an empty path. Warnings go to stderr. @throws InputError
[[nodiscard]] std::optional<Arm> ReadArmArgument(const std::string& path);

[[nodiscard]] RobotNames NamesOf(const Arm& arm);

}  // namespace calibrato
