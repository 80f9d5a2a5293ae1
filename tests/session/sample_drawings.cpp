// SPDX-License-Identifier: Apache-2.0
#include "tests/session/sample_drawings.h"

#include <cmath>
#include <numbers>
#include <stdexcept>

#include "drawing/png_file.h"
#include "geometry/polygon.h"
#include "session/placements.h"

namespace posespace {
namespace {

constexpr double kTwoPi = 2.0 * std::numbers::pi;

// The angle from `from` to `to`, in [-pi, pi].
double AngleBetween(double from, double to) { return std::remainder(to - from, kTwoPi); }

Points Ring(double lift, double turn, int count) {
  struct Arm {
    double direction, length, width;
  };
  const Arm arms[] = {{0.3 + lift, 70.0, 0.30}, {2.2, 45.0, 0.35}, {4.3, 55.0, 0.32}};
  Points ring(count, 2);
  for (int k = 0; k < count; ++k) {
    const double angle = kTwoPi * k / count;
    double radius = 22.0;
    for (const Arm& arm : arms) {
      const double off = AngleBetween(arm.direction, angle) / arm.width;
      radius += arm.length * std::exp(-off * off);
    }
    ring.row(k) << 100.0 + radius * std::cos(angle + turn), 100.0 + radius * std::sin(angle + turn);
  }
  return ring;
}

}  // namespace

Points CreatureRing(double lift, int count) { return Ring(lift, 0.0, count); }

Points TurnedCreatureRing(double turn) { return Ring(0.0, turn, 60); }

ShapeSource CreaturePolygon(double lift, int count) {
  return PolygonSource{CreatureRing(lift, count), {}, {}};
}

ShapeSource CreaturePicture(double lift, int size) {
  const Points ring = CreatureRing(lift, 60) * (size / 200.0);
  Image image{size, size, std::vector<std::uint8_t>(4 * static_cast<std::size_t>(size) * size)};
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      if (Locate(Point(x + 0.5, y + 0.5), ring) < 0) continue;
      const std::uint8_t orange[] = {240, 140, 20, 255};
      std::copy(std::begin(orange), std::end(orange), image.at(x, y));
    }
  }
  return ImageSource{EncodePng(image)};
}

std::shared_ptr<const Drawing> DrawingOf(const std::string& id, const ShapeSource& source) {
  auto drawing = ReadDrawing(id, source, Limits());
  if (!drawing) throw std::runtime_error(drawing.error().message);
  return std::make_shared<const Drawing>(std::move(*drawing));
}

BuildInputs CreatureInputs(int count) {
  BuildInputs inputs;
  for (int i = 0; i < count; ++i) {
    inputs.drawings.push_back(
        DrawingOf("pose" + std::to_string(i), CreaturePolygon(0.25 * i - 0.3)));
  }
  inputs.placements = DefaultPlacements(count);
  inputs.options.improvement.target_edge_length = 0.25;
  return inputs;
}

BuildInputs LongInputs() {
  BuildInputs inputs;
  for (int i = 0; i < 6; ++i) {
    inputs.drawings.push_back(
        DrawingOf("pose" + std::to_string(i), CreaturePolygon(0.2 * i - 0.5, 2000)));
  }
  inputs.placements = DefaultPlacements(6);
  inputs.options.simplification.tolerance = 0.001;
  inputs.options.improvement.target_edge_length = 0.02;
  return inputs;
}

}  // namespace posespace
