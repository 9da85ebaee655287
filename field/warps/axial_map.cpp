#include "field/warps/axial_map.h"

#include <optional>

#include "field/warps/axis_tube.h"

namespace kelpie {

namespace {

/// What is nowhere is this many sizes of the tubes away: far from anything that a field has, and not so far that rounding moves it.
constexpr double k_nowhere = 1e5;
constexpr Interval k_jump{-1e30, 1e30}; // finite, so that products with 0 stay numbers

template <class T>
struct ScalarOf {
  using type = T;
};
template <class T, int N>
struct ScalarOf<Dual<T, N>> {
  using type = T;
};

Point3<AxialMap::Slopes> variables(const Vec3d& p) {
  using D = AxialMap::Slopes;
  return {D::variable(p.x, 0), D::variable(p.y, 1), D::variable(p.z, 2)};
}

double number(const double& value, const std::array<double, 3>&, double) { return value; }
template <class T>
Dual<T, 3> number(const T& value, const std::array<T, 3>& slopes, Dual<T, 3>) {
  return {value, slopes};
}

template <class Real>
Real squared_distance(const Point3<Real>& a, const Point3<Real>& b) {
  return square(a.x - b.x) + square(a.y - b.y) + square(a.z - b.z);
}
/// x^2 (3 - 2x) for x in [0, 1].
double smooth_step(double x) { return x * x * (3 - 2 * x); }
Interval smooth_step(Interval x) { return {smooth_step(x.lo), smooth_step(x.hi)}; }
template <class T>
Dual<T, 3> smooth_step(const Dual<T, 3>& x) {
  return chain(x, smooth_step(x.value), 6.0 * (x.value * (T(1.0) - x.value)));
}

/// 1 where two displacements are so near each other that a border can join them, 0 where they are too far apart.
template <class Real>
Real agreement(const Point3<Real>& a, const Point3<Real>& b, const Real& limit) {
  const Real squared = squared_distance(a, b);
  const double apart = std::sqrt(range_of(squared).hi), most = range_of(limit).lo;
  if (apart <= 0.5 * most) return Real(1.0);
  if (apart >= most) return Real(0.0);
  return smooth_step(Real(2.0) - 2.0 * sqrt(squared) / limit);
}

} // namespace

/// What an axis offers, with its share.
template <class Real>
struct AxialMap::Offer {
  Point3<Real> by;
  Real depth, share, limit; ///< depth: in borders, so that who is deepest has the most of a share

  explicit Offer(const AxisOffer<typename ScalarOf<Real>::type>& o)
      : by{number(o.by[0], o.by_slopes[0], Real()), number(o.by[1], o.by_slopes[1], Real()), number(o.by[2], o.by_slopes[2], Real())},
        depth(number(o.depth, o.depth_slopes, Real()) * (1 / o.border)), limit(number(o.limit, o.limit_slopes, Real())) {
    share = range_of(depth).lo >= 1 ? Real(1.0) : smooth_step(clamp(depth, 0, 1));
  }
};

AxialMap::AxialMap(std::span<const AxisShape> shapes) {
  Box3d all;
  for (const AxisShape& shape : shapes) {
    const AxisTube& tube = tubes_.emplace_back(shape);
    all.extend(tube.deformed().box()), all.extend(tube.rest().box());
  }
  // An axis that stands keeps its tube from others; where all stand there is nothing to keep.
  if (std::none_of(tubes_.begin(), tubes_.end(), [](const AxisTube& tube) { return tube.moves(); })) tubes_.clear();
  if (!all.is_empty()) nowhere_ = k_nowhere * std::max(all.diagonal(), 1e-300);
}

AxialMap::~AxialMap() = default;

template <class Real>
void AxialMap::collect(const Vec3d& p, std::vector<Offer<Real>>& offers) const {
  AxisOffer<double> offer;
  offers.clear();
  for (const AxisTube& tube : tubes_)
    if (tube.offer(p, !std::is_same_v<Real, double>, offer)) offers.emplace_back(offer);
}

/// Whether what was there at rest has been moved away.
bool AxialMap::is_vacated(const Vec3d& p) const {
  Vec3d by;
  double limit = 0;
  return std::any_of(tubes_.begin(), tubes_.end(),
                     [&](const AxisTube& tube) { return tube.move(p, by, limit) && glm::dot(by, by) > limit * limit; });
}

template <class Real>
Point3<Real> AxialMap::join(const Point3<Real>& p, const Vec3d& at) const {
  thread_local std::vector<Offer<Real>> offers;
  collect(at, offers);
  const Point3<Real> nowhere{p.x + Real(nowhere_), p.y, p.z};
  if (offers.empty()) return is_vacated(at) ? nowhere : p;
  const auto moved = [&](const Point3<Real>& by) { return Point3<Real>{p.x + by.x, p.y + by.y, p.z + by.z}; };
  if (offers.size() == 1 && range_of(offers[0].share).lo == 1) return moved(offers[0].by);

  // Whoever has the point deepest in its tube has it, or nobody, in the outer half of borders; others have a share as far as they
  // agree about where it was.
  const Offer<Real>* deepest = &offers[0];
  Real sum(0.0);
  for (const Offer<Real>& o : offers) {
    if (range_of(o.depth).lo > range_of(deepest->depth).lo) deepest = &o;
    sum = sum + o.share;
  }
  const bool is_owned = range_of(deepest->share).lo >= 0.5;
  const Real rest = max(Real(0.0), Real(1.0) - sum);
  if (!is_owned && is_vacated(at)) return nowhere;
  const Point3<Real> stay{Real(0.0), Real(0.0), Real(0.0)}, chosen = is_owned ? deepest->by : stay;
  Point3<Real> by = stay;
  Real shares = rest * (is_owned ? agreement(chosen, stay, deepest->limit) : Real(1.0));
  for (const Offer<Real>& o : offers) {
    const Real share = is_owned && &o == deepest ? o.share : o.share * agreement(o.by, chosen, min(o.limit, deepest->limit));
    by = {by.x + share * o.by.x, by.y + share * o.by.y, by.z + share * o.by.z};
    shares = shares + share;
  }
  if (!(range_of(shares).lo > 0)) return p;
  return moved({by.x / shares, by.y / shares, by.z / shares});
}

Point3<double> AxialMap::rest(const Point3<double>& p) const { return join<double>(p, {p.x, p.y, p.z}); }
Point3<AxialMap::Slopes> AxialMap::rest_with_slopes(const Vec3d& p) const { return join<Slopes>(variables(p), p); }

Point3<AxialMap::Range> AxialMap::rest_of(const Box3d& box) const {
  Point3<Range> out;
  bound(box, out, nullptr);
  return out;
}
bool AxialMap::torn_images(const Box3d& box, std::vector<Box3d>& images) const {
  Point3<Range> hull;
  images.clear();
  return bound(box, hull, &images);
}

/// What the tubes offer to the points of a box, and where that takes all of them: each way is asked for in turn, and answers only if it
/// is sure to be right for all.
class AxialMap::BoxOffers {
public:
  using Image = std::optional<Point3<Range>>;

  BoxOffers(const AxialMap& map, const Box3d& box) : p_{variable(box, 0), variable(box, 1), variable(box, 2)}, nowhere_(map.nowhere_) {
    AxisOffer<Interval> offer;
    for (const AxisTube& tube : map.tubes_)
      if (tube.offer(box, offer)) offers_.emplace_back(offer);
    for (const Offer<Range>& o : offers_) {
      shares_ = shares_ + o.share.value;
      least_limit_ = std::min(least_limit_, o.limit.value.lo), most_limit_ = std::max(most_limit_, o.limit.value.hi);
      if (!deepest_ || o.depth.value.lo > deepest_->depth.value.lo) deepest_ = &o;
    }
    stays_out_ = shares_.lo >= 1;
    is_owned_ = deepest_ && deepest_->share.value.lo >= 0.5;
    if (is_owned_) return;
    for (const AxisTube& tube : map.tubes_) {
      const AxisTube::Moved moved = tube.moved(box);
      may_be_gone_ = may_be_gone_ || moved.some, is_gone_ = is_gone_ || moved.all;
    }
  }

  /// All offers agree with each other and with what stays, or only one has a share.
  Image joined() const {
    if (!all_agree()) return {};
    if (offers_.empty()) return p_;
    if (offers_.size() == 1 && stays_out_) return moved(offers_[0].by);
    Point3<Range> by{};
    Range sum(0.0);
    for (const Offer<Range>& o : offers_) {
      by = {by.x + o.share * o.by.x, by.y + o.share * o.by.y, by.z + o.share * o.by.z};
      sum = sum + o.share;
    }
    if (shares_.hi <= 1) return moved(by);
    const Range all = max(Range(1.0), sum);
    return moved({by.x / all, by.y / all, by.z / all});
  }

  /// The deepest has all: the others disagree with it.
  Image owned() const {
    if (!is_owned_) return {};
    const auto has_no_share = [&](const Offer<Range>& o) { return &o == deepest_ || o.share.value.hi <= 0; };
    const auto yields = [&](const Offer<Range>& o) {
      return has_no_share(o) ||
             (o.depth.value.hi < deepest_->depth.value.lo && apart(o.by, deepest_->by).lo >= min(o.limit.value, deepest_->limit.value).hi);
    };
    if (!std::all_of(offers_.begin(), offers_.end(), yields)) return {};
    const Interval from_stay = apart(deepest_->by, k_stay);
    if (stays_out_ || from_stay.lo >= deepest_->limit.value.hi) return moved(deepest_->by);
    if (!(from_stay.lo > 0) || !std::all_of(offers_.begin(), offers_.end(), has_no_share)) return {};
    // What stays has less of a share the less it agrees.
    const Range agreed = smooth_step(clamp(Range(2.0) - 2.0 * sqrt(squared_distance(deepest_->by, k_stay)) / deepest_->limit, 0, 1));
    const Range& share = deepest_->share;
    const Range part = within(share / (share + (Range(1.0) - share) * agreed), {share.value.lo, 1});
    return moved({part * deepest_->by.x, part * deepest_->by.y, part * deepest_->by.z});
  }

  /// No offer is taken: what was there at rest counts, which stays or has been moved away.
  Image unmoved() const {
    const auto is_refused = [&](const Offer<Range>& o) {
      return o.share.value.hi <= 0 || (o.share.value.hi < 0.5 && apart(o.by, k_stay).lo >= o.limit.value.hi);
    };
    if (!std::all_of(offers_.begin(), offers_.end(), is_refused)) return {};
    if (is_gone_) return moved(nowhere());
    return may_be_gone_ ? Image{} : p_;
  }

  /// Anything between what is offered, with a jump.
  Point3<Range> hull() const {
    Point3<Range> by = may_stay() ? k_stay : offers_[0].by;
    const auto add = [&](const Point3<Range>& b) { by = {either(by.x, b.x), either(by.y, b.y), either(by.z, b.z)}; };
    for (const Offer<Range>& o : offers_) add(o.by);
    if (may_be_gone_ || is_gone_) add(nowhere());
    Point3<Range> out = moved(by);
    for (Range* r : {&out.x, &out.y, &out.z}) r->d.fill(k_jump);
    return out;
  }

  /// The same one by one, no farther from what is chosen than it agrees with others.
  void add_images(const Box3d& box, std::vector<Box3d>& images) const {
    if (may_stay() && !is_gone_) images.push_back(box.padded(most_limit_));
    for (const Offer<Range>& o : offers_) {
      if (o.share.value.hi < 0.5) continue;
      const Point3<Range> q = moved(o.by);
      images.push_back(Box3d{{q.x.value.lo, q.y.value.lo, q.z.value.lo}, {q.x.value.hi, q.y.value.hi, q.z.value.hi}}.padded(most_limit_));
    }
  }

private:
  static Range variable(const Box3d& box, int i) { return Range::variable({box.lower[i], box.upper[i]}, i); }
  static Interval apart(const Point3<Range>& a, const Point3<Range>& b) { return sqrt(squared_distance(a, b).value); }
  Point3<Range> moved(const Point3<Range>& by) const { return {p_.x + by.x, p_.y + by.y, p_.z + by.z}; }
  Point3<Range> nowhere() const { return {Range(nowhere_), Range(0.0), Range(0.0)}; }
  bool may_stay() const { return !(stays_out_ && is_owned_); }

  bool all_agree() const {
    const auto agree = [&](const Point3<Range>& a, const Point3<Range>& b) { return apart(a, b).hi <= 0.5 * least_limit_; };
    if (may_be_gone_) return false;
    for (size_t i = 0; i < offers_.size(); ++i) {
      if (!stays_out_ && !agree(offers_[i].by, k_stay)) return false;
      for (size_t j = 0; j < i; ++j)
        if (!agree(offers_[i].by, offers_[j].by)) return false;
    }
    return true;
  }

  inline static const Point3<Range> k_stay{};

  Point3<Range> p_;
  double nowhere_;
  std::vector<Offer<Range>> offers_;
  const Offer<Range>* deepest_ = nullptr; ///< for sure the deepest, if it has all
  Interval shares_{0.0};                  ///< the sum of all
  double least_limit_ = INFINITY, most_limit_ = 0;
  bool stays_out_ = false;                     ///< what stays has no share anywhere in the box
  bool is_owned_ = false;                      ///< an axis has the points: in the outer half of borders, what was there at rest counts
  bool may_be_gone_ = false, is_gone_ = false; ///< whether what was there at rest has been moved away: some of it, all of it
};

/// Into `out`, for all points at once; whether the map may jump, and then, one by one, what it may jump between.
bool AxialMap::bound(const Box3d& box, Point3<Range>& out, std::vector<Box3d>* images) const {
  const BoxOffers offers(*this, box);
  for (const auto way : {&BoxOffers::joined, &BoxOffers::owned, &BoxOffers::unmoved})
    if (const BoxOffers::Image image = (offers.*way)()) return out = *image, false;
  if (images) offers.add_images(box, *images);
  out = offers.hull();
  return true;
}

bool AxialMap::alone(const Box3d& box, double tolerance, std::vector<AxisPiece>& pieces) const {
  pieces.clear();
  std::vector<AxisOffer<Interval>> offers;
  std::vector<const AxisTube*> tubes;
  AxisOffer<Interval> offer;
  for (const AxisTube& tube : tubes_)
    if (tube.offer(box, offer) && offer.depth.hi > 0) offers.push_back(offer), tubes.push_back(&tube);
  const auto moves = [&](const AxisOffer<Interval>& o) {
    return std::any_of(o.by.begin(), o.by.end(), [&](const Interval& by) { return by.magnitude() > 1e-3 * tolerance; });
  };
  if (std::none_of(offers.begin(), offers.end(), moves))
    return std::none_of(tubes_.begin(), tubes_.end(), [&](const AxisTube& tube) { return tube.moved(box).some; });
  size_t owner = 0;
  for (size_t i = 1; i < offers.size(); ++i)
    if (offers[i].depth.lo / offers[i].border > offers[owner].depth.lo / offers[owner].border) owner = i;
  const AxisOffer<Interval>& deepest = offers[owner];
  // It has the point without a share for what stays; what differs much from it has none at all.
  Interval moved2(0.0);
  for (const Interval& by : deepest.by) moved2 = moved2 + square(by);
  const bool is_far = moved2.lo >= square(deepest.limit.hi) && deepest.depth.lo > 0.501 * deepest.border;
  if (deepest.depth.lo < deepest.border && !is_far) return false;
  // The others differ so much from it that it joins none of them.
  const auto yields = [&](const AxisOffer<Interval>& o) {
    if (&o == &deepest) return true;
    Interval apart2(0.0);
    for (size_t i = 0; i < 3; ++i) apart2 = apart2 + square(o.by[i] - deepest.by[i]);
    return o.depth.hi / o.border < deepest.depth.lo / deepest.border && apart2.lo >= square(std::min(o.limit.hi, deepest.limit.hi));
  };
  return std::all_of(offers.begin(), offers.end(), yields) && tubes[owner]->pieces(box, tolerance, pieces);
}

Point3<double> AxialMap::deformed(const Point3<double>& q) const {
  if (tubes_.empty()) return q;
  const Vec3d target{q.x, q.y, q.z};
  const auto rest_at = [&](const Vec3d& p) {
    const Point3<double> r = rest({p.x, p.y, p.z});
    return Vec3d(r.x, r.y, r.z);
  };
  std::vector<Vec3d> starts{target};
  const Vec3d back{target.x - nowhere_, target.y, target.z};
  if (glm::distance(rest_at(back), target) < 1e-9 * nowhere_) return {back.x, back.y, back.z};
  Vec3d by, all(0);
  double limit = 0, count = 0;
  for (const AxisTube& tube : tubes_)
    if (tube.move(target, by, limit)) starts.push_back(target + by), all += by, count += 1;
  if (count > 1) starts.push_back(target + all / count);
  const double close = 1e-11 * (1e-5 * nowhere_ + glm::length(target));
  Vec3d best = target;
  double least = INFINITY;
  for (const Vec3d& start : starts) {
    const double error = glm::distance(rest_at(start), target);
    if (error < least) least = error, best = start;
  }
  if (least <= close) return {best.x, best.y, best.z};
  for (const Vec3d& start : starts) {
    Vec3d p = start;
    for (int i = 0; i < 40; ++i) {
      const Point3<Slopes> r = rest_with_slopes(p);
      const Vec3d error = Vec3d(r.x.value, r.y.value, r.z.value) - target;
      if (glm::length(error) <= close) return {p.x, p.y, p.z};
      Mat3d slopes;
      for (int j = 0; j < 3; ++j) slopes[j] = {r.x.d[j], r.y.d[j], r.z.d[j]};
      if (!(std::abs(glm::determinant(slopes)) > 1e-9)) break;
      p -= glm::inverse(slopes) * error;
    }
  }
  return {best.x, best.y, best.z};
}

Box3d AxialMap::image_of(const Box3d& box) const {
  double most = 0;
  for (const AxisTube& tube : tubes_) most = std::max(most, tube.most_limit());
  Box3d image = box.padded(most);
  for (const AxisTube& tube : tubes_) tube.extend_image(box, image);
  return image;
}

} // namespace kelpie
