#include "calibrato/sensors/camera_model.h"

#include <iterator>
#include <utility>

#include "calibrato/base/input_error.h"

namespace calibrato {
namespace {

using Variant = CameraModel::Variant;

size_t ModelIndex(std::string_view name) {
  const auto found = std::find(kCameraModelNames.begin(), kCameraModelNames.end(), name);
  if (found == kCameraModelNames.end()) {
    std::string known;
    for (const std::string_view candidate : kCameraModelNames) {
      known += (known.empty() ? "" : ", ") + std::string(candidate);
    }
    throw InputError(
        {"unknown camera model '" + std::string(name) + "'", "", "", "use one of " + known});
  }
  return static_cast<size_t>(found - kCameraModelNames.begin());
}

// Calls the function with the type of the model of that name, as a std::type_identity.
template <typename Function>
auto WithModelType(std::string_view name, const Function& function) {
  const size_t index = ModelIndex(name);
  return [&]<size_t... I>(std::index_sequence<I...>) {
    using Result = std::invoke_result_t<Function, std::type_identity<PinholeRadtan<0>>>;
    std::optional<Result> result;
    (void)((I == index &&
            (result.emplace(function(std::type_identity<std::variant_alternative_t<I, Variant>>{})),
             true)) ||
           ...);
    return *std::move(result);
  }
  (std::make_index_sequence<std::variant_size_v<Variant>>{});
}

std::string Join(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : " ") + word;
  return text;
}

Variant MakeVariant(std::string_view name, const Eigen::VectorXd& parameters) {
  return WithModelType(name, [&]<typename Model>(std::type_identity<Model>) -> Variant {
    if (parameters.size() != Model::kNumParameters) {
      throw InputError(
          {"wrong number of camera parameters for " + std::string(name), "",
           "expected " + std::to_string(Model::kNumParameters) + ", got " +
               std::to_string(parameters.size()),
           "give the intrinsics, then the distortion: " + Join(CameraModel::ParameterNames(name))});
    }
    if (!AreValidParameters<Model>(parameters)) {
      const std::string constraint(Model::kConstraint);
      throw InputError({"camera parameters out of range for " + std::string(name), "",
                        "focal lengths must be positive and every parameter finite" +
                            (constraint.empty() ? "" : ", and " + constraint),
                        "check the order " + Join(CameraModel::ParameterNames(name))});
    }
    return Model(parameters);
  });
}

}  // namespace

CameraModel::CameraModel(std::string_view name, const Eigen::VectorXd& parameters)
    : model_(MakeVariant(name, parameters)) {}

int CameraModel::NumParameters(std::string_view name) {
  return WithModelType(
      name, []<typename Model>(std::type_identity<Model>) -> int { return Model::kNumParameters; });
}

int CameraModel::NumIntrinsics(std::string_view name) {
  return WithModelType(
      name, []<typename Model>(std::type_identity<Model>) -> int { return Model::kNumIntrinsics; });
}

std::vector<std::string> CameraModel::ParameterNames(std::string_view name) {
  return WithModelType(name,
                       []<typename Model>(std::type_identity<Model>) -> std::vector<std::string> {
                         const auto begin = Model::kParameterNames.begin();
                         return {begin, begin + Model::kNumParameters};
                       });
}

std::string_view CameraModel::name() const { return kCameraModelNames[model_.index()]; }

Eigen::VectorXd CameraModel::parameters() const {
  return std::visit([](const auto& model) -> Eigen::VectorXd { return model.parameters(); },
                    model_);
}

int CameraModel::num_parameters() const {
  return std::visit([](const auto& model) { return model.kNumParameters; }, model_);
}

Eigen::VectorXd CameraModel::intrinsics() const {
  return std::visit(
      [](const auto& model) -> Eigen::VectorXd {
        return model.parameters().head(model.kNumIntrinsics);
      },
      model_);
}

Eigen::VectorXd CameraModel::distortion() const {
  return std::visit(
      [](const auto& model) -> Eigen::VectorXd {
        return model.parameters().tail(model.kNumParameters - model.kNumIntrinsics);
      },
      model_);
}

std::optional<Eigen::Vector2d> CameraModel::Project(const Eigen::Vector3d& p_c) const {
  Eigen::Vector2d pixel;
  const bool inside = std::visit(
      [&](const auto& model) { return model.Project(p_c, &pixel, nullptr, nullptr); }, model_);
  return inside ? std::make_optional(pixel) : std::nullopt;
}

std::optional<Eigen::Vector3d> CameraModel::Unproject(const Eigen::Vector2d& pixel) const {
  return std::visit([&](const auto& model) { return model.Unproject(pixel); }, model_);
}

bool CoversImage(const CameraModel& model, Resolution resolution) {
  // The distortion grows with the radius, so the border decides; corners lie farthest out.
  const Eigen::Vector4d k = model.focal_and_centre();
  const double right = resolution.width - 1;
  const double bottom = resolution.height - 1;
  for (const double u : {0.0, right}) {
    for (const double v : {0.0, bottom}) {
      const Eigen::Vector3d sideways((u - k(2)) / k(0), (v - k(3)) / k(1), 0.0);
      if (!model.Unproject({u, v}) && !model.Project(sideways)) return false;
    }
  }
  return true;
}

}  // namespace calibrato
