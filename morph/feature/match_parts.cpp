#include "morph/feature/match_parts.h"

#include <algorithm>
#include <limits>

#include "base/vec.h"

namespace kelpie {

namespace {

/// Parts that differ more are not the same: in parts of the solid, places count fully, sizes by half.
constexpr double k_most_difference = 0.35, k_size_share = 0.5;
/// Mirror images may be off by this.
constexpr double k_mirror_tolerance = 0.12;

/// A box in parts of the box around the solid.
struct Outline {
  Vec3d centre{0}, size{0};

  Outline() = default;
  Outline(const PartBox& part, const Box3d& solid) {
    const Vec3d extent = glm::max(solid.extent(), Vec3d(1e-12));
    Vec3d upright(0);
    for (int i = 0; i < 3; ++i) upright += glm::abs(part.axes[i]) * part.size[i];
    centre = (part.centre - solid.lower) / extent, size = upright / extent;
  }
  friend double difference(const Outline& a, const Outline& b) {
    return glm::distance(a.centre, b.centre) + k_size_share * glm::distance(a.size, b.size);
  }
};

/// A feature in the making.
struct Group {
  std::vector<int> parts;
  Outline sum;
  int count = 0;

  Outline mean() const {
    Outline m;
    m.centre = sum.centre / double(count), m.size = sum.size / double(count);
    return m;
  }
  void add(size_t solid, int part, const Outline& outline) {
    parts[solid] = part, sum.centre += outline.centre, sum.size += outline.size, ++count;
  }
};

/// Gives the parts of a solid to groups, or new ones.
void assign(const PartedSolid& solid, size_t number, size_t solids, std::vector<Group>& groups) {
  std::vector<Outline> outlines;
  for (const PartBox& box : solid.boxes) outlines.emplace_back(box, solid.box);
  // Beside the groups each part has a column of its own, at the price of what is too different.
  std::vector<std::vector<double>> cost;
  for (size_t i = 0; i < outlines.size(); ++i) {
    std::vector<double>& row = cost.emplace_back();
    for (const Group& group : groups) row.push_back(difference(outlines[i], group.mean()));
    for (size_t k = 0; k < outlines.size(); ++k) row.push_back(k == i ? k_most_difference : 1e6);
  }
  const size_t known = groups.size();
  const std::vector<int> columns = least_assignment(cost);
  for (size_t i = 0; i < outlines.size(); ++i) {
    if (size_t(columns[i]) >= known) groups.push_back({std::vector<int>(solids, -1), {}, 0});
    Group& group = size_t(columns[i]) < known ? groups[size_t(columns[i])] : groups.back();
    group.add(number, int(i), outlines[i]);
  }
}

/// The group that is most like a group's mirror image in x; itself if none is.
size_t nearest_to_image(const std::vector<Group>& groups, size_t of) {
  Outline image = groups[of].mean();
  image.centre.x = 1 - image.centre.x;
  size_t best = of;
  double least = k_mirror_tolerance;
  for (size_t i = 0; i < groups.size(); ++i)
    if (const double d = difference(groups[i].mean(), image); d < least) least = d, best = i;
  return best;
}

/// Two groups are mirror images if each is most like the other's; else a group is its own.
size_t mirror_image(const std::vector<Group>& groups, size_t of) {
  const size_t image = nearest_to_image(groups, of);
  return nearest_to_image(groups, image) == of ? image : of;
}

} // namespace

std::vector<int> least_assignment(const std::vector<std::vector<double>>& cost) {
  const size_t rows = cost.size(), columns = rows == 0 ? 0 : cost[0].size();
  constexpr double k_infinity = std::numeric_limits<double>::infinity();
  // Rows and columns from 1; 0 is none. Prices keep all reduced costs at 0 or more.
  std::vector<double> row_price(rows + 1, 0), column_price(columns + 1, 0);
  std::vector<size_t> row_of(columns + 1, 0), before(columns + 1, 0);
  for (size_t row = 1; row <= rows; ++row) {
    std::vector<double> least(columns + 1, k_infinity);
    std::vector<char> used(columns + 1, false);
    size_t column = 0;
    row_of[0] = row;
    do { // the shortest way to a free column
      used[column] = true;
      const size_t at = row_of[column];
      double step = k_infinity;
      size_t next = 0;
      for (size_t j = 1; j <= columns; ++j) {
        if (used[j]) continue;
        const double reduced = cost[at - 1][j - 1] - row_price[at] - column_price[j];
        if (reduced < least[j]) least[j] = reduced, before[j] = column;
        if (least[j] < step) step = least[j], next = j;
      }
      for (size_t j = 0; j <= columns; ++j)
        if (used[j])
          row_price[row_of[j]] += step, column_price[j] -= step;
        else
          least[j] -= step;
      column = next;
    } while (row_of[column] != 0);
    for (; column != 0; column = before[column]) row_of[column] = row_of[before[column]];
  }
  std::vector<int> out(rows);
  for (size_t j = 1; j <= columns; ++j)
    if (row_of[j] != 0) out[row_of[j] - 1] = int(j) - 1;
  return out;
}

std::vector<ProposedFeature> match_parts(const std::vector<PartedSolid>& solids) {
  std::vector<size_t> order; // those of many parts first, so that others find theirs
  for (size_t i = 0; i < solids.size(); ++i) order.push_back(i);
  std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) { return solids[a].boxes.size() > solids[b].boxes.size(); });
  std::vector<Group> groups;
  for (const size_t i : order) assign(solids[i], i, solids.size(), groups);
  std::erase_if(groups, [](const Group& g) { return g.count < 2; });
  std::stable_sort(groups.begin(), groups.end(), [](const Group& a, const Group& b) { return a.mean().centre.y < b.mean().centre.y; });

  std::vector<std::string> names(groups.size());
  int letter = 0;
  for (size_t i = 0; i < groups.size(); ++i) {
    if (!names[i].empty()) continue;
    const std::string name = std::string("part_") + (letter < 26 ? std::string(1, char('a' + letter)) : std::to_string(letter + 1));
    ++letter;
    const size_t image = mirror_image(groups, i);
    if (image == i) {
      names[i] = name;
    } else {
      const bool is_left = groups[i].mean().centre.x < groups[image].mean().centre.x;
      names[i] = name + (is_left ? "_left" : "_right"), names[image] = name + (is_left ? "_right" : "_left");
    }
  }
  std::vector<ProposedFeature> features;
  for (size_t i = 0; i < groups.size(); ++i) features.push_back({names[i], groups[i].parts});
  return features;
}

} // namespace kelpie
