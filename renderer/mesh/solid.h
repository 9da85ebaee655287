// What can be meshed: a region of space, by a function that is above 0 inside.
#pragma once

#include "renderer/program/program.h"

namespace kelpie {

/// A closed region. What its function needs to know in a box and in all that lies in it is `Code`: the part of a program that matters
/// there; a solid without a program has none.
class Solid {
public:
  enum class Content { empty, full, unknown };
  struct InBox {
    Content content = Content::unknown; ///< proved, unless unknown
    Code code;
  };

  virtual ~Solid() = default;

  /// Of all that is not empty.
  virtual Box3d bounds() const = 0;
  virtual Code code() const = 0;
  virtual InBox in_box(const Box3d&, const Code& parent) const = 0;
  /// Above 0 inside, in any unit.
  virtual double value(const Code&, const Vec3d&) const = 0;
  virtual Vec3d gradient(const Code&, const Vec3d&) const = 0;
  /// Whether the surface in the box is proved to be one sheet: the value falls along some direction everywhere.
  virtual bool is_one_sheet(const Code&, const Box3d&) const = 0;
  /// A value so near 0 that the place is on the surface.
  virtual double close() const = 0;
};

/// What lies within the surface of a field.
class FieldSolid : public Solid {
public:
  /// Throws Error, bad_data, where the field has no end. The program must outlive it and stand.
  explicit FieldSolid(const FieldProgram&);

  Box3d bounds() const override { return bounds_; }
  Code code() const override { return program_.code; }
  InBox in_box(const Box3d&, const Code& parent) const override;
  double value(const Code&, const Vec3d&) const override;
  Vec3d gradient(const Code&, const Vec3d&) const override;
  bool is_one_sheet(const Code&, const Box3d&) const override;
  double close() const override { return 1e-6 * program_.threshold; }

private:
  const FieldProgram& program_;
  Box3d bounds_;
};

} // namespace kelpie
