#include "kerf/study/report/label_places.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace kerf::report {

bool LabelPlaces::is_free(const Area& area) const {
  return picture_.contains(area) &&
         std::none_of(taken_.begin(), taken_.end(), [&](const Area& other) { return other.overlaps(area); });
}

Area LabelPlaces::place(double x, double y, double width, double height) {
  constexpr double kDistances[] = {7, 13, 20, 28, 38, 50, 64, 80, 100};
  constexpr std::pair<double, double> kDirections[] = {{1, 0},    {-1, 0},  {0, -1},    {0, 1},  // beside, above, below
                                                       {1, -1},   {1, 1},   {-1, -1},   {-1, 1},    // at the corners
                                                       {1, -0.5}, {1, 0.5}, {-1, -0.5}, {-1, 0.5},  // and between
                                                       {0.4, -1}, {0.4, 1}, {-0.4, -1}, {-0.4, 1}};
  const auto at = [&](double distance, const std::pair<double, double>& direction) {
    const double middle_x = x + direction.first * (distance + width / 2);
    const double middle_y = y + direction.second * (direction.first == 0 ? distance + height / 2 : distance * 0.8);
    return Area{middle_x - width / 2, middle_y - height / 2, middle_x + width / 2, middle_y + height / 2};
  };
  const Area found = at(kDistances[0], kDirections[0]);
  for (const double distance : kDistances) {
    for (const auto& direction : kDirections) {
      const Area area = at(distance, direction);
      if (!is_free(area)) continue;
      taken_.push_back(area);
      return area;
    }
  }
  taken_.push_back(found);
  return found;
}

std::vector<double> spread_column(const std::vector<double>& middles, double distance, double top, double bottom) {
  std::vector<size_t> order(middles.size());
  std::iota(order.begin(), order.end(), size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) { return middles[a] < middles[b]; });
  std::vector<double> placed = middles;
  double least = top;
  for (const size_t i : order) {
    placed[i] = std::max(placed[i], least);
    least = placed[i] + distance;
  }
  std::reverse(order.begin(), order.end());
  double most = bottom;
  for (const size_t i : order) {
    placed[i] = std::min(placed[i], most);
    most = placed[i] - distance;
  }
  return placed;
}

}  // namespace kerf::report
