// SPDX-License-Identifier: Apache-2.0
#include "interpolation/blend_scratch.h"

#include <algorithm>
#include <cstddef>
#include <new>

#include "interpolation/blend_tables.h"

namespace posespace {
namespace {

class ThreadMemory {
 public:
  float* AtLeast(std::size_t count) {
    if (count > count_) {
      count_ = 0;
      memory_ = hwy::AllocateAligned<float>(count);
      if (!memory_) throw std::bad_alloc();
      std::fill_n(memory_.get(), count, 0.0f);
      count_ = count;
    }
    return memory_.get();
  }

 private:
  AlignedArray<float> memory_;
  std::size_t count_ = 0;
};

}  // namespace

BlendScratch ThreadScratch(const BlendTables& tables, int lanes) {
  constexpr std::size_t kLine = 16;   // floats
  constexpr std::size_t kSpare = 32;  // a last step over a part may reach past the vertices
  const auto rows = [&](std::size_t count) {
    return (count * static_cast<std::size_t>(lanes) + kSpare + kLine - 1) / kLine * kLine;
  };
  const auto poses = static_cast<std::size_t>(tables.num_poses);
  const auto vertices = static_cast<std::size_t>(tables.num_vertices);
  const auto parts = static_cast<std::size_t>(tables.num_parts);
  const std::size_t triangles = static_cast<std::size_t>(tables.num_blocks) * kTriangleBlock;
  const std::size_t work = lanes == 1 ? 11 * triangles + 2 * vertices + 2 * kSpare : 5 * triangles;

  thread_local ThreadMemory memory;
  float* next = memory.AtLeast(2 * rows(poses) + rows(6 * parts) + rows(2 + 2 * parts) + rows(1) +
                               6 * rows(vertices) + rows(work));
  const auto take = [&](std::size_t count) {
    float* const start = next;
    next += rows(count);
    return start;
  };
  return {.rotation_weights = take(poses),
          .stretch_weights = take(poses),
          .moments = reinterpret_cast<double*>(take(6 * parts)),
          .placing = take(2 + 2 * parts),
          .clear = take(1),
          .x = take(vertices),
          .y = take(vertices),
          .z_x = take(vertices),
          .z_y = take(vertices),
          .step_x = take(vertices),
          .step_y = take(vertices),
          .triangles = take(work)};
}

}  // namespace posespace
