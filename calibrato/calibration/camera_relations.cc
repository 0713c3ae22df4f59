#include "calibrato/calibration/camera_relations.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <tuple>

namespace calibrato {
namespace {

constexpr size_t kMaxCentres = 50;

struct SharedView {
  size_t a;
  size_t b;
};

std::vector<SharedView> SharedViews(const CameraFit& a, const std::vector<int>& frames_a,
                                    const CameraFit& b, const std::vector<int>& frames_b) {
  std::vector<SharedView> shared;
  for (size_t i = 0, j = 0; i < a.views.size() && j < b.views.size();) {
    if (frames_a[i] < frames_b[j]) {
      ++i;
    } else if (frames_b[j] < frames_a[i]) {
      ++j;
    } else {
      if (a.views[i].count() > 0 && b.views[j].count() > 0) shared.push_back({i, j});
      ++i;
      ++j;
    }
  }
  return shared;
}

double Distance(const Rigid3& a, const Rigid3& b, double length_m) {
  const Eigen::Matrix<double, 6, 1> delta = a.DifferenceTo(b);
  return delta.head<3>().norm() + delta.tail<3>().norm() / length_m;
}

// T_cb_ca.
Rigid3 Relation(const CameraFit& a, const CameraFit& b, const std::vector<SharedView>& shared) {
  std::vector<Rigid3> estimates;
  std::vector<double> depths;
  for (const auto& [i, j] : shared) {
    estimates.push_back(b.views[j].T_c_g * a.views[i].T_c_g.Inverse());
    depths.push_back(a.views[i].T_c_g.t.norm());
  }
  std::nth_element(depths.begin(), depths.begin() + depths.size() / 2, depths.end());
  return RobustMean(estimates, depths[depths.size() / 2]);
}

}  // namespace

int NumSharedFrames(const CameraFit& a, const std::vector<int>& frame_of_view_a, const CameraFit& b,
                    const std::vector<int>& frame_of_view_b) {
  return static_cast<int>(SharedViews(a, frame_of_view_a, b, frame_of_view_b).size());
}

Rigid3 RobustMean(const std::vector<Rigid3>& poses, double length_m) {
  const size_t stride = (poses.size() + kMaxCentres - 1) / kMaxCentres;
  Rigid3 mean = poses.front();
  double least = -1.0;
  for (size_t i = 0; i < poses.size(); i += stride) {
    double sum = 0.0;
    for (const Rigid3& pose : poses) sum += std::min(1.0, Distance(pose, poses[i], length_m));
    if (least >= 0.0 && sum >= least) continue;
    least = sum;
    mean = poses[i];
  }
  for (int round = 0; round < 10; ++round) {
    std::vector<double> distances;
    for (const Rigid3& pose : poses) distances.push_back(Distance(pose, mean, length_m));
    std::vector<double> sorted = distances;
    std::nth_element(sorted.begin(), sorted.begin() + sorted.size() / 2, sorted.end());
    const double scale = sorted[sorted.size() / 2] + 1e-12;
    Eigen::Matrix<double, 6, 1> step = Eigen::Matrix<double, 6, 1>::Zero();
    double total = 0.0;
    for (size_t i = 0; i < poses.size(); ++i) {
      const double ratio = distances[i] / (2.0 * scale);
      const double weight = 1.0 / ((1.0 + ratio * ratio) * (1.0 + ratio * ratio));
      step += weight * poses[i].DifferenceTo(mean);
      total += weight;
    }
    mean = mean.Perturbed(step / total);
  }
  return mean;
}

std::vector<CameraGroup> RelateCameras(const std::vector<CameraFit>& fits,
                                       const std::vector<std::vector<int>>& frame_of_view) {
  const size_t n = fits.size();
  std::vector<std::tuple<int, size_t, size_t>> links;  // -shared frames, a, b
  for (size_t a = 0; a < n; ++a) {
    for (size_t b = a + 1; b < n; ++b) {
      const int shared = NumSharedFrames(fits[a], frame_of_view[a], fits[b], frame_of_view[b]);
      if (shared > 0) links.emplace_back(-shared, a, b);
    }
  }
  std::sort(links.begin(), links.end());
  // Kruskal's maximum spanning forest; each camera's pose in the frame of its group's root.
  std::vector<size_t> root(n);
  std::iota(root.begin(), root.end(), size_t{0});
  std::vector<Rigid3> T_c_root(n);
  for (const auto& [negative, a, b] : links) {
    if (root[a] == root[b]) continue;
    const Rigid3 T_cb_ca = Relation(
        fits[a], fits[b], SharedViews(fits[a], frame_of_view[a], fits[b], frame_of_view[b]));
    const Rigid3 T_rootb_roota = T_c_root[b].Inverse() * T_cb_ca * T_c_root[a];
    const size_t old_root = root[b];
    for (size_t c = 0; c < n; ++c) {
      if (root[c] != old_root) continue;
      T_c_root[c] = T_c_root[c] * T_rootb_roota;
      root[c] = root[a];
    }
  }
  std::vector<CameraGroup> groups;
  std::vector<std::optional<size_t>> group_of_root(n);
  for (size_t c = 0; c < n; ++c) {
    auto& g = group_of_root[root[c]];
    if (!g) {
      g = groups.size();
      groups.emplace_back();
    }
    CameraGroup& group = groups[*g];
    if (!group.cameras.empty()) {
      const auto before = static_cast<size_t>(group.cameras.back());
      group.T_cn_cnm1.push_back(T_c_root[c] * T_c_root[before].Inverse());
    }
    group.cameras.push_back(static_cast<int>(c));
  }
  return groups;
}

}  // namespace calibrato
