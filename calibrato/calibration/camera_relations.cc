#include "calibrato/calibration/camera_relations.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <tuple>

#include "calibrato/geometry/so3.h"

namespace calibrato {
namespace {

constexpr size_t kMaxCentres = 50;
// Enough frames to tell relations apart that differ by a turn of the board.
constexpr size_t kMaxVotes = 200;
// Relations whose mean distance to what the frames say [rad] differs by less are as good as each
// other; a wrong one is off by the motion of the board from frame to frame.
constexpr double kAsGood = 0.05;
// Relations that are nearer to each other [rad] are one.
constexpr double kSameRelation = 0.3;

struct SharedView {
  size_t a;
  size_t b;
};

std::vector<SharedView> SharedViews(const CameraFit& a, const std::vector<int>& frames_a,
                                    const CameraFit& b, const std::vector<int>& frames_b) {
  std::vector<SharedView> shared;
  if (!a.model || !b.model) return shared;
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

struct Relation {
  Rigid3 T_cb_ca;
  bool is_side_known = true;
};

// What one frame says of T_cb_ca, one for each way to number the board's points in camera b.
using FrameVotes = std::vector<Rigid3>;

const Rigid3& Nearest(const FrameVotes& votes, const Rigid3& T, double length_m) {
  return *std::min_element(votes.begin(), votes.end(), [&](const Rigid3& a, const Rigid3& b) {
    return Distance(a, T, length_m) < Distance(b, T, length_m);
  });
}

double MeanDistance(const std::vector<FrameVotes>& frames, const Rigid3& T, double length_m) {
  const size_t stride = (frames.size() + kMaxVotes - 1) / kMaxVotes;
  double sum = 0.0;
  double count = 0.0;
  for (size_t f = 0; f < frames.size(); f += stride) {
    sum += std::min(1.0, Distance(Nearest(frames[f], T, length_m), T, length_m));
    count += 1.0;
  }
  return sum / count;
}

// The relation that the frames agree on best, each with its best way to number the board. Of those
// that are as good, the one of least turn: cameras of a rig are seldom mounted upside down.
Relation AgreedOn(const std::vector<FrameVotes>& frames, double length_m) {
  struct Candidate {
    Rigid3 T;
    double distance;
  };
  std::vector<Candidate> candidates;
  const size_t stride = (frames.size() + kMaxCentres - 1) / kMaxCentres;
  for (size_t f = 0; f < frames.size(); f += stride) {
    for (const Rigid3& T : frames[f]) {
      candidates.push_back({T, MeanDistance(frames, T, length_m)});
    }
  }
  const auto turn = [](const Candidate& candidate) { return LogSo3(candidate.T.R).norm(); };
  const double least =
      std::min_element(candidates.begin(), candidates.end(), [](const auto& a, const auto& b) {
        return a.distance < b.distance;
      })->distance;
  std::erase_if(candidates, [&](const auto& c) { return c.distance > least + kAsGood; });
  const Candidate best =
      *std::min_element(candidates.begin(), candidates.end(),
                        [&](const auto& a, const auto& b) { return turn(a) < turn(b); });
  const bool is_known = std::all_of(candidates.begin(), candidates.end(), [&](const auto& c) {
    return Distance(c.T, best.T, length_m) < kSameRelation;
  });
  return {best.T, is_known};
}

Relation RelationOf(const CameraFit& a, const CameraFit& b, const std::vector<SharedView>& shared,
                    const std::vector<BoardTurn>& turns) {
  std::vector<FrameVotes> frames;
  std::vector<double> depths;
  for (const auto& [i, j] : shared) {
    const Rigid3 T_g_ca = a.views[i].T_c_g.Inverse();
    frames.push_back({b.views[j].T_c_g * T_g_ca});
    for (const BoardTurn& turn : turns) {
      frames.back().push_back(b.views[j].T_c_g * turn.T_g_turned * T_g_ca);
    }
    depths.push_back(a.views[i].T_c_g.t.norm());
  }
  std::nth_element(depths.begin(), depths.begin() + depths.size() / 2, depths.end());
  const double length_m = depths[depths.size() / 2];
  Relation relation;
  if (!turns.empty()) relation = AgreedOn(frames, length_m);
  std::vector<Rigid3> estimates;
  for (const FrameVotes& votes : frames) {
    estimates.push_back(turns.empty() ? votes.front() : Nearest(votes, relation.T_cb_ca, length_m));
  }
  relation.T_cb_ca = RobustMean(estimates, length_m);
  return relation;
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

Rigid3 CameraGroup::T_to_from(size_t to, size_t from) const {
  if (to < from) return T_to_from(from, to).Inverse();
  Rigid3 T;
  for (size_t k = from; k < to; ++k) T = T_cn_cnm1[k] * T;
  return T;
}

std::vector<CameraGroup> RelateCameras(const std::vector<CameraFit>& fits,
                                       const std::vector<std::vector<int>>& frame_of_view,
                                       const std::vector<BoardTurn>& turns) {
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
  std::vector<bool> is_side_known(n, true);
  for (const auto& [negative, a, b] : links) {
    if (root[a] == root[b]) continue;
    const Relation relation = RelationOf(
        fits[a], fits[b], SharedViews(fits[a], frame_of_view[a], fits[b], frame_of_view[b]), turns);
    is_side_known[a] = is_side_known[a] && relation.is_side_known;
    const Rigid3 T_rootb_roota = T_c_root[b].Inverse() * relation.T_cb_ca * T_c_root[a];
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
    group.is_side_known = group.is_side_known && is_side_known[c];
  }
  return groups;
}

}  // namespace calibrato
