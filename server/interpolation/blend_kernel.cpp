// SPDX-License-Identifier: Apache-2.0
#include "interpolation/blend_kernel.h"

#include <cstring>

// This file is compiled once for every set of vector instructions.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "interpolation/blend_kernel.cpp"
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)  // no better than their neighbours here
#include "hwy/foreach_target.h"
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace posespace {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

using Lanes16 = hn::CappedTag<float, 16>;  // of poses in a group; of triangles and rows alone
template <class D>
using Vec = hn::Vec<D>;

// The parts are compiled in here, for each set of instructions anew; the first is the others' base.
#include "interpolation/blend_arithmetic.inc"
#include "interpolation/blend_many_poses.inc"
#include "interpolation/blend_one_pose.inc"

BlendKernel Kernel() {
  return {static_cast<int>(hn::Lanes(Lanes16())),
          SolveGroup,
          PlaceGroup,
          SolveAlone,
          PlaceAlone,
          hwy::TargetName(HWY_TARGET)};
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace posespace
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace posespace {

HWY_EXPORT(Kernel);

const BlendKernel& BestBlendKernel() {
  static const BlendKernel kernel = HWY_DYNAMIC_DISPATCH(Kernel)();
  return kernel;
}

}  // namespace posespace
#endif  // HWY_ONCE
