#include "calibrato/diagnosis/frame_selection.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "calibrato/base/input_error.h"

namespace calibrato {
namespace {

using testing::HasSubstr;

// A corner list in which the board stands at each of these places [px], one a frame.
CameraProblem CameraThatSees(const std::vector<double>& places) {
  CameraProblem camera;
  camera.resolution = {640, 480};
  for (const double place : places) {
    BoardView view;
    view.corner_ids = {0, 1, 2, 3};
    view.pixels.resize(2, 4);
    view.pixels << place, place + 50.0, place, place + 50.0,  //
        100.0, 100.0, 150.0, 150.0;
    view.points_g.resize(3, 4);
    view.points_g << 0.0, 0.05, 0.0, 0.05, 0.0, 0.0, 0.05, 0.05, 0.0, 0.0, 0.0, 0.0;
    camera.views.push_back(view);
  }
  return camera;
}

CameraRigProblem RigThatSees(const std::vector<std::vector<double>>& places_of_cameras) {
  CameraRigProblem problem;
  for (const std::vector<double>& places : places_of_cameras) {
    problem.cameras.push_back(CameraThatSees(places));
    std::vector<int>& frames = problem.frame_of_view.emplace_back();
    for (size_t v = 0; v < places.size(); ++v) frames.push_back(static_cast<int>(v));
  }
  return problem;
}

TEST(SelectFrames, SaysNothingWhereAllViewsDiffer) {
  CameraRigProblem problem = RigThatSees({{0, 10, 20, 30}});
  EXPECT_TRUE(SelectFrames(FrameSelection::kAll, &problem).empty());
  EXPECT_EQ(problem.cameras[0].views.size(), 4U);
}

TEST(SelectFrames, SaysHowMuchTooSmallSigmasAreWhereViewsRepeatAnother) {
  // Four views of which one is new: as many measurements as one, so sigmas are half of what they
  // should be.
  CameraRigProblem problem = RigThatSees({{0, 10, 20, 30}, {7, 7, 7.1, 7}});
  const std::vector<Finding> findings = SelectFrames(FrameSelection::kAll, &problem);
  ASSERT_EQ(findings.size(), 1U);
  EXPECT_THAT(findings[0].what, HasSubstr("cam1: 3 of 4 views repeat another"));
  EXPECT_THAT(findings[0].what, HasSubstr("up to 50 % too small"));
  EXPECT_THAT(findings[0].remedy, HasSubstr("--select distinct"));
  EXPECT_EQ(problem.cameras[1].views.size(), 4U);
}

TEST(SelectFrames, KeepsAFrameThatIsDistinctInOneCameraForAll) {
  CameraRigProblem problem = RigThatSees({{0, 10, 10, 30}, {7, 7, 7, 7}});
  const std::vector<Finding> findings = SelectFrames(FrameSelectionFromName("distinct"), &problem);
  EXPECT_EQ(problem.frame_of_view[0], (std::vector<int>{0, 1, 3}));
  EXPECT_EQ(problem.frame_of_view[1], (std::vector<int>{0, 1, 3}));
  EXPECT_EQ(problem.cameras[1].views.size(), 3U);
  ASSERT_EQ(findings.size(), 1U);
  EXPECT_THAT(findings[0].what, HasSubstr("3 of 4 frames were selected"));
}

TEST(FrameSelectionFromName, RefusesOthers) {
  EXPECT_THROW(static_cast<void>(FrameSelectionFromName("best")), InputError);
}

}  // namespace
}  // namespace calibrato
