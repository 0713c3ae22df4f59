#include "calibrato/evaluation/foreign_camera.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <opencv2/calib3d.hpp>
#include <sstream>

#include "calibrato/base/files.h"
#include "calibrato/base/value.h"
#include "calibrato/evaluation/outside_program.h"

namespace calibrato {
namespace {

constexpr int kNumParameters = 9;
constexpr double kMrcalLimit = 120.0;  // [s]

// As mrcal sees the board, its z axis away from the camera: its x is our x, along the row index;
// its y is our y turned round.
std::string CornersFile(const std::vector<BoardView>& views, const Checkerboard& board) {
  std::string text = "# filename x y level\n";
  for (size_t v = 0; v < views.size(); ++v) {
    char name[40];
    std::snprintf(name, sizeof(name), "frame%06zu.png", v);
    for (int column = board.columns - 1; column >= 0; --column) {
      for (int row = 0; row < board.rows; ++row) {
        const Eigen::Index k = row * board.columns + column;
        text += std::string(name) + " " + FormatNumber(views[v].pixels(0, k)) + " " +
                FormatNumber(views[v].pixels(1, k)) + " 0\n";
      }
    }
  }
  return text;
}

// The list of numbers behind 'intrinsics': in a .cameramodel, which is Python's notation.
std::optional<Eigen::VectorXd> IntrinsicsIn(const std::string& text) {
  const size_t key = text.find("'intrinsics':");
  const size_t open = text.find('[', key);
  const size_t close = text.find(']', open);
  if (key == std::string::npos || open == std::string::npos || close == std::string::npos) {
    return std::nullopt;
  }
  std::string numbers = text.substr(open + 1, close - open - 1);
  std::replace(numbers.begin(), numbers.end(), ',', ' ');
  std::istringstream words(numbers);
  Eigen::VectorXd parameters(kNumParameters);
  for (double& parameter : parameters) {
    if (!(words >> parameter)) return std::nullopt;
  }
  return parameters;
}

}  // namespace

ForeignCamera CalibrateByOpenCv(const std::vector<BoardView>& views, Resolution resolution) {
  std::vector<std::vector<cv::Point3f>> points;
  std::vector<std::vector<cv::Point2f>> pixels;
  for (const BoardView& view : views) {
    auto& of_board = points.emplace_back();
    auto& of_image = pixels.emplace_back();
    for (Eigen::Index k = 0; k < view.num_corners(); ++k) {
      const Eigen::Vector3f p = view.points_g.col(k).cast<float>();
      const Eigen::Vector2f uv = view.pixels.col(k).cast<float>();
      of_board.emplace_back(p.x(), p.y(), p.z());
      of_image.emplace_back(uv.x(), uv.y());
    }
  }
  ForeignCamera camera;
  const auto start = std::chrono::steady_clock::now();
  try {
    cv::Mat matrix;
    cv::Mat distortion;
    cv::Mat sigmas;
    cv::Mat rotations;
    cv::Mat translations;
    cv::Mat sigmas_of_poses;
    cv::Mat errors;
    cv::calibrateCamera(points, pixels, cv::Size(resolution.width, resolution.height), matrix,
                        distortion, rotations, translations, sigmas, sigmas_of_poses, errors);
    camera.parameters.resize(kNumParameters);
    camera.parameters << matrix.at<double>(0, 0), matrix.at<double>(1, 1), matrix.at<double>(0, 2),
        matrix.at<double>(1, 2), distortion.at<double>(0), distortion.at<double>(1),
        distortion.at<double>(2), distortion.at<double>(3), distortion.at<double>(4);
    camera.sigmas = Eigen::Vector4d(sigmas.at<double>(0), sigmas.at<double>(1),
                                    sigmas.at<double>(2), sigmas.at<double>(3));
    if (!camera.parameters.allFinite()) camera.failure = "not finite";
  } catch (const cv::Exception& error) {
    camera.failure = "it threw: " + error.err;
  }
  camera.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return camera;
}

ForeignCamera CalibrateByMrcal(const std::vector<BoardView>& views, Resolution resolution,
                               const Checkerboard& board) {
  std::vector<BoardView> whole;
  for (const BoardView& view : views) {
    if (view.num_corners() == board.rows * board.columns) whole.push_back(view);
  }
  const ProgramFolder folder;
  WriteFileAtomically(folder.PathOf("corners.vnl"), CornersFile(whole, board));
  const ProgramEnd end = RunOutsideProgram(
      {"mrcal-calibrate-cameras", "--corners-cache", "corners.vnl", "--lensmodel",
       "LENSMODEL_OPENCV5", "--focal", std::to_string(resolution.width), "--imagersize",
       std::to_string(resolution.width), std::to_string(resolution.height), "--object-spacing",
       FormatNumber(board.row_spacing_m), "--object-width-n", std::to_string(board.rows),
       "--object-height-n", std::to_string(board.columns), "--outdir", ".", "frame*.png"},
      folder.path(), kMrcalLimit);
  ForeignCamera camera;
  camera.seconds = end.seconds;
  if (!end.is_success) {
    camera.failure = end.why;
    return camera;
  }
  for (const auto& entry : std::filesystem::directory_iterator(folder.path())) {
    if (entry.path().extension() != ".cameramodel") continue;
    if (const auto parameters = IntrinsicsIn(ReadFile(entry.path().string()))) {
      camera.parameters = *parameters;
      return camera;
    }
  }
  camera.failure = "left no camera model";
  return camera;
}

}  // namespace calibrato
