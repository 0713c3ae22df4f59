#include "calibrato/rendering/coverage.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace calibrato {

CoverageSum::CoverageSum(Resolution resolution)
    : width_(resolution.width),
      height_(resolution.height),
      changes_(static_cast<size_t>(width_ + 2) * height_, 0.0F) {}

void CoverageSum::AddSide(const Eigen::Vector2d& a, const Eigen::Vector2d& b, double weight) {
  // What lies above and below is cut off; so are crossings of the left and the right edge, since
  // what is left of the raster counts by its height alone and what is right of it not at all.
  const double dy = b.y() - a.y();
  if (dy == 0.0 || std::max(a.y(), b.y()) <= 0.0 || std::min(a.y(), b.y()) >= height_) return;
  if (std::min(a.x(), b.x()) >= width_) return;
  const double dx = b.x() - a.x();
  double cuts[4] = {0.0, 1.0, 0.0, 0.0};
  int num_cuts = 2;
  if (a.y() < 0.0) cuts[0] = -a.y() / dy;
  if (a.y() > height_) cuts[0] = (height_ - a.y()) / dy;
  if (b.y() < 0.0) cuts[1] = -a.y() / dy;
  if (b.y() > height_) cuts[1] = (height_ - a.y()) / dy;
  const double first = cuts[0];
  const double last = cuts[1];
  for (const double edge : {0.0, static_cast<double>(width_)}) {
    if ((a.x() < edge) == (b.x() < edge)) continue;
    const double cut = (edge - a.x()) / dx;
    if (cut > first && cut < last) cuts[num_cuts++] = cut;
  }
  std::sort(cuts, cuts + num_cuts);
  const auto height_at = [&](double t) {
    if (t == 0.0) return a.y();  // sides that share an end must share it to the last bit
    if (t == 1.0) return b.y();
    return std::clamp(a.y() + t * dy, 0.0, static_cast<double>(height_));
  };
  for (int k = 0; k + 1 < num_cuts; ++k) {
    const double x0 = std::clamp(cuts[k] == 0.0 ? a.x() : a.x() + cuts[k] * dx, 0.0, width_ + 0.0);
    const double x1 =
        std::clamp(cuts[k + 1] == 1.0 ? b.x() : a.x() + cuts[k + 1] * dx, 0.0, width_ + 0.0);
    AddInside(x0, height_at(cuts[k]), x1, height_at(cuts[k + 1]), weight);
  }
}

void CoverageSum::AddInside(double x0, double y0, double x1, double y1, double weight) {
  if (y0 == y1) return;
  if (y0 > y1) {
    std::swap(x0, x1);
    std::swap(y0, y1);
    weight = -weight;
  }
  const double slope = (x1 - x0) / (y1 - y0);
  const int last_row = std::min(height_ - 1, static_cast<int>(y1));
  double x = x0;
  double y = y0;
  for (int row = static_cast<int>(y0); row <= last_row; ++row) {
    const double next_y = row == last_row ? y1 : row + 1.0;
    const double next_x =
        row == last_row ? x1 : std::clamp(x0 + slope * (next_y - y0), 0.0, width_ + 0.0);
    const double cover = weight * (next_y - y);
    float* cells = changes_.data() + static_cast<size_t>(row) * (width_ + 2);
    const double left = std::min(x, next_x);
    const double right = std::max(x, next_x);
    const int first = static_cast<int>(left);
    const int last = static_cast<int>(right);
    if (first == last) {
      // Within one cell: a trapezium of it lies to the right, all of the next ones.
      const double part = 1.0 - (0.5 * (left + right) - first);
      cells[first] += static_cast<float>(cover * part);
      cells[first + 1] += static_cast<float>(cover * (1.0 - part));
    } else {
      // Through several: a triangle in the first, trapezia, all but a triangle in the last.
      const double cover_per_cell = cover / (right - left);
      double covered = 0.0;  // share of the cell before, which lasts for all further ones
      for (int cell = first; cell <= last; ++cell) {
        const double from = std::max(left - cell, 0.0);
        const double to = std::min(right - cell, 1.0);
        const double here = covered + cover_per_cell * (to - from) * (1.0 - 0.5 * (from + to));
        const double through = covered + cover_per_cell * (to - from);
        cells[cell] += static_cast<float>(here - covered);
        cells[cell + 1] += static_cast<float>(through - here);
        covered = through;
      }
    }
    x = next_x;
    y = next_y;
  }
}

std::vector<float> CoverageSum::Finish(double base) && {
  // In place: a fine raster is large, and its cells come to stand before its changes.
  for (int row = 0; row < height_; ++row) {
    const float* changes = changes_.data() + static_cast<size_t>(row) * (width_ + 2);
    float* cells = changes_.data() + static_cast<size_t>(row) * width_;
    auto sum = static_cast<float>(base);
    for (int column = 0; column < width_; ++column) {
      sum += changes[column];
      cells[column] = sum;
    }
  }
  changes_.resize(static_cast<size_t>(width_) * height_);
  return std::move(changes_);
}

}  // namespace calibrato
