#include "rendered_boards.h"

#include <Eigen/Geometry>
#include <numbers>

namespace calibrato {

Camera CameraForTest(const std::string& model) {
  Eigen::VectorXd parameters(8);
  if (model == "pinhole-radtan") {
    parameters << 500.0, 500.0, 319.5, 239.5, -0.28, 0.08, 0.0005, -0.0003;
  } else {
    parameters << 260.0, 260.0, 319.5, 239.5, -0.01, 0.004, -0.002, 0.0005;
  }
  return {CameraModel(model, parameters), {640, 480}, "", std::nullopt};
}

Rigid3 PoseOf(const Board& board, const Camera& camera, const BoardPlace& place) {
  const Eigen::Vector3d axis(std::cos(place.tilt_axis), std::sin(place.tilt_axis), 0.0);
  const Eigen::Vector3d ray = camera.model.Unproject(place.pixel).value().normalized();
  const Eigen::Matrix3d R_c_g = (Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), ray) *
                                 Eigen::AngleAxisd(place.tilt, axis) *
                                 Eigen::AngleAxisd(place.roll, Eigen::Vector3d::UnitZ()) *
                                 Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitX()))
                                    .toRotationMatrix();
  return {R_c_g, place.distance_m * ray - R_c_g * BoardCentre(board)};
}

Eigen::Matrix2Xd TruthOf(const Board& board, const Camera& camera, const Rigid3& T_c_g) {
  const Eigen::Matrix3Xd points_g = BoardPoints(board);
  Eigen::Matrix2Xd pixels(2, points_g.cols());
  for (Eigen::Index k = 0; k < points_g.cols(); ++k) {
    const Eigen::Vector3d p_c = T_c_g * Eigen::Vector3d(points_g.col(k));
    pixels.col(k) = camera.model.Project(p_c).value_or(Eigen::Vector2d(-1000.0, -1000.0));
  }
  return pixels;
}

Scene SceneForTest() {
  Scene scene;
  scene.blur_px = 0.5;
  scene.lighting_gradient = {0.1, -0.1};
  scene.vignetting = 0.2;
  return scene;
}

GreyImage ImageOf(const Board& board, const Camera& camera, const Rigid3& T_c_g) {
  return Digitised(RenderBoard(PatternOf(board), camera, T_c_g, SceneForTest()));
}

}  // namespace calibrato
