#pragma once

#include <cstddef>
#include <vector>

namespace kerf::report {

/// A rectangle of a picture, y downwards.
struct Area {
  double left = 0, top = 0, right = 0, bottom = 0;

  bool overlaps(const Area& o) const { return left < o.right && o.left < right && top < o.bottom && o.top < bottom; }
  bool contains(const Area& o) const {
    return left <= o.left && o.right <= right && top <= o.top && o.bottom <= bottom;
  }
};

/// Finds room for labels beside points: nearest first, nothing covered that stands already. What comes first is placed
/// first, so that the same picture comes out each time.
class LabelPlaces {
 public:
  explicit LabelPlaces(const Area& picture) : picture_(picture) {}

  /// What no label may cover.
  void block(const Area& area) { taken_.push_back(area); }
  /// Where a label of this size stands for a point; the area is taken. At the point's right where nothing is free.
  Area place(double x, double y, double width, double height);

 private:
  bool is_free(const Area& area) const;

  Area picture_;
  std::vector<Area> taken_;
};

/// Moves the middles of labels in a column apart until they are `distance` apart and within [top, bottom], where that
/// can be, and as near to where they were as a simple rule finds. Keeps their order.
std::vector<double> spread_column(const std::vector<double>& middles, double distance, double top, double bottom);

}  // namespace kerf::report
