#include "kerf/trace/triangle_filter.h"

#include "kerf/base/instruction_set.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "kerf/trace/triangle_filter.cpp"
#include "kerf/base/simd.h"

HWY_BEFORE_NAMESPACE();
namespace kerf {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// detail::may_hit_triangle() for many triangles at once, with the same bound on the error.
size_t filter(const TriangleColumns& triangles, const PreparedRay& ray, size_t begin, size_t end, uint32_t* out) {
  const hn::ScalableTag<float> d;
  const hn::RebindToUnsigned<decltype(d)> du;
  const size_t lanes = hn::Lanes(d);
  const float* column[3][3];  // by corner, then sheared x, y, z
  const uint32_t axes[3] = {ray.kx, ray.ky, ray.kz};
  for (size_t corner = 0; corner < 3; ++corner) {
    for (size_t i = 0; i < 3; ++i) column[corner][i] = triangles.column(corner, axes[i]);
  }
  const auto origin_x = hn::Set(d, (&ray.origin.x)[ray.kx]);
  const auto origin_y = hn::Set(d, (&ray.origin.x)[ray.ky]);
  const auto origin_z = hn::Set(d, (&ray.origin.x)[ray.kz]);
  const auto shear_x = hn::Set(d, ray.shear_x), shear_y = hn::Set(d, ray.shear_y);
  size_t found = 0;
  for (size_t i = begin; i < end; i += lanes) {
    const auto az = hn::Sub(hn::LoadU(d, column[0][2] + i), origin_z);
    const auto bz = hn::Sub(hn::LoadU(d, column[1][2] + i), origin_z);
    const auto cz = hn::Sub(hn::LoadU(d, column[2][2] + i), origin_z);
    const auto ax = hn::Sub(hn::Sub(hn::LoadU(d, column[0][0] + i), origin_x), hn::Mul(shear_x, az));
    const auto bx = hn::Sub(hn::Sub(hn::LoadU(d, column[1][0] + i), origin_x), hn::Mul(shear_x, bz));
    const auto cx = hn::Sub(hn::Sub(hn::LoadU(d, column[2][0] + i), origin_x), hn::Mul(shear_x, cz));
    const auto ay = hn::Sub(hn::Sub(hn::LoadU(d, column[0][1] + i), origin_y), hn::Mul(shear_y, az));
    const auto by = hn::Sub(hn::Sub(hn::LoadU(d, column[1][1] + i), origin_y), hn::Mul(shear_y, bz));
    const auto cy = hn::Sub(hn::Sub(hn::LoadU(d, column[2][1] + i), origin_y), hn::Mul(shear_y, cz));
    const auto u = hn::Sub(hn::Mul(cx, by), hn::Mul(cy, bx));
    const auto v = hn::Sub(hn::Mul(ax, cy), hn::Mul(ay, cx));
    const auto w = hn::Sub(hn::Mul(bx, ay), hn::Mul(by, ax));
    const auto sx = hn::Max(hn::Max(hn::Abs(ax), hn::Abs(bx)), hn::Abs(cx));
    const auto sy = hn::Max(hn::Max(hn::Abs(ay), hn::Abs(by)), hn::Abs(cy));
    const auto s = hn::Max(sx, sy);
    const auto z = hn::Max(hn::Max(hn::Abs(az), hn::Abs(bz)), hn::Abs(cz));
    const auto scaled = hn::Mul(hn::Set(d, 0x1p-19F), hn::Mul(s, hn::Add(s, z)));
    const auto error = hn::Add(scaled, hn::Set(d, 0x1p-120F));
    // Overflow makes NaN, and what Max does with one differs: so a triangle is left out only where u, v and w are all
    // numbers, which the sums below tell.
    const auto is_number = hn::Eq(hn::Mul(hn::Add(hn::Add(u, v), w), hn::Zero(d)), hn::Zero(d));
    const auto outside =
        hn::And(hn::Lt(hn::Min(hn::Min(u, v), w), hn::Neg(error)), hn::Gt(hn::Max(hn::Max(u, v), w), error));
    const auto may_hit = hn::Not(hn::And(outside, is_number));
    if (hn::AllFalse(d, may_hit)) continue;
    const auto numbers = hn::Iota(du, static_cast<uint32_t>(i));
    found += hn::CompressStore(numbers, hn::RebindMask(du, may_hit), du, out + found);
  }
  while (found > 0 && out[found - 1] >= end) --found;  // from the padding
  return found;
}

TriangleFilter kernel() { return &filter; }

}  // namespace HWY_NAMESPACE
}  // namespace kerf
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace kerf {

HWY_EXPORT(kernel);

void TriangleColumns::reserve(size_t count) {
  for (std::vector<float>& column : columns_) column.reserve(count + kPadding);
}

void TriangleColumns::add(const Triangle& triangle) {
  const Vec3f corners[3] = {triangle.a, triangle.b, triangle.c};
  for (size_t i = 0; i < 9; ++i) columns_[i].push_back(corners[i / 3][static_cast<uint32_t>(i % 3)]);
  ++size_;
}

void TriangleColumns::finish() {
  for (std::vector<float>& column : columns_) column.resize(size_ + kPadding);
}

TriangleKernels triangle_kernels() {
  const InstructionSet set = chosen_instruction_set();
  return {KERF_DISPATCH(kernel, set)(), set.name};
}

}  // namespace kerf
#endif
