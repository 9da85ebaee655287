#include "tests/reference/bernstein.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace reference {

namespace {

/// De Casteljau: the parts left and right of s.
std::pair<Polynomial, Polynomial> split(const Polynomial& p, double s) {
  Polynomial left, right = p;
  for (int i = 0; i <= k_degree; ++i) {
    left.c[i] = right.c[0];
    for (int j = 0; j < k_degree - i; ++j) right.c[j] = right.c[j] * (1 - s) + right.c[j + 1] * s;
  }
  return {left, right};
}

int sign_variations(const Polynomial& p) {
  int count = 0;
  double last = 0;
  for (const double c : p.c) {
    if (c == 0) continue;
    count += last * c < 0;
    last = c;
  }
  return count;
}

/// The one root in [lo, hi] of a polynomial whose signs at the ends differ.
double bisect(const Polynomial& p, double lo, double hi) {
  const bool rises = p(lo) < 0;
  for (int i = 0; i < 60 && hi - lo > 1e-15; ++i) {
    const double middle = 0.5 * (lo + hi);
    ((p(middle) < 0) == rises ? lo : hi) = middle;
  }
  return 0.5 * (lo + hi);
}

/// `p` is `whole` on [lo, hi]. By Descartes' rule no variation means no root and one means one root; with
/// more, halve.
void isolate(const Polynomial& whole, const Polynomial& p, double lo, double hi, double noise, std::vector<double>& out) {
  const int variations = sign_variations(p);
  if (variations == 0) return;
  const bool is_noise = std::max(std::abs(p.least()), std::abs(p.most())) < noise;
  if (is_noise || hi - lo < 1e-13) {
    out.push_back(0.5 * (lo + hi));
    return;
  }
  if (variations == 1 && p.c.front() != 0 && p.c.back() != 0) {
    out.push_back(bisect(whole, lo, hi));
    return;
  }
  const double middle = 0.5 * (lo + hi);
  const auto [left, right] = split(p, 0.5);
  isolate(whole, left, lo, middle, noise, out);
  if (left.c.back() == 0 && middle < 1) out.push_back(middle);
  isolate(whole, right, middle, hi, noise, out);
}

} // namespace

double Polynomial::operator()(double s) const {
  std::array<double, k_degree + 1> r = c;
  for (int i = k_degree; i > 0; --i)
    for (int j = 0; j < i; ++j) r[j] = r[j] * (1 - s) + r[j + 1] * s;
  return r[0];
}

double Polynomial::least() const { return *std::min_element(c.begin(), c.end()); }
double Polynomial::most() const { return *std::max_element(c.begin(), c.end()); }

Polynomial Polynomial::part(double from, double to) const {
  const Polynomial head = to < 1 ? split(*this, to).first : *this;
  return from > 0 ? split(head, from / to).second : head;
}

Polynomial operator+(Polynomial a, const Polynomial& b) {
  for (int i = 0; i <= k_degree; ++i) a.c[i] += b.c[i];
  return a;
}

Polynomial operator-(const Polynomial& a) { return a * -1; }

Polynomial operator*(Polynomial a, double s) {
  for (double& c : a.c) c *= s;
  return a;
}

Polynomial constant(double v) {
  Polynomial p;
  p.c.fill(v);
  return p;
}

Polynomial square_times_linear(const Quadratic& q, double a, double b) {
  const std::array<double, 5> square{q[0] * q[0], q[0] * q[1], (q[0] * q[2] + 2 * q[1] * q[1]) / 3, q[1] * q[2], q[2] * q[2]};
  const Quadratic linear{a + b * q[0], a + b * q[1], a + b * q[2]};
  // The product of degrees 4 and 2: coefficient i + j gathers C(4, i) C(2, j) / C(6, i + j).
  constexpr double k_choose4[] = {1, 4, 6, 4, 1}, k_choose2[] = {1, 2, 1}, k_choose6[] = {1, 6, 15, 20, 15, 6, 1};
  Polynomial p;
  for (int i = 0; i <= 4; ++i)
    for (int j = 0; j <= 2; ++j) p.c[i + j] += k_choose4[i] * k_choose2[j] * square[i] * linear[j];
  for (int k = 0; k <= k_degree; ++k) p.c[k] /= k_choose6[k];
  return p;
}

std::vector<double> sign_changes(const Polynomial& p, double noise) {
  std::vector<double> roots;
  isolate(p, p, 0, 1, noise, roots);
  return roots;
}

} // namespace reference
