#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace calibrato {

/// Checks of an option's number that, unlike those of CLI11, NaN does not pass.
[[nodiscard]] inline CLI::Validator NumberBetween(double low, double high) {
  CLI::Validator validator;
  validator.description("FLOAT in [" + CLI::detail::to_string(low) + " - " +
                        CLI::detail::to_string(high) + "]");
  validator.operation([low, high](std::string& input) {
    double value = 0.0;
    const bool is_inside = CLI::detail::lexical_cast(input, value) && value >= low && value <= high;
    return is_inside ? std::string()
                     : "Value " + input + " not in range [" + CLI::detail::to_string(low) + " - " +
                           CLI::detail::to_string(high) + "]";
  });
  return validator;
}

/// Above 0 and finite.
[[nodiscard]] inline CLI::Validator FinitePositive() {
  CLI::Validator validator;
  validator.description("POSITIVE");
  validator.operation([](std::string& input) {
    constexpr double kLargest = 1e300;
    double value = 0.0;
    const bool is_positive =
        CLI::detail::lexical_cast(input, value) && value > 0.0 && value <= kLargest;
    return is_positive ? std::string() : "Value " + input + " is not a positive number";
  });
  return validator;
}

}  // namespace calibrato
