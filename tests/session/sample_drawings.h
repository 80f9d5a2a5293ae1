// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_TESTS_SESSION_SAMPLE_DRAWINGS_H_
#define POSESPACE_TESTS_SESSION_SAMPLE_DRAWINGS_H_

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "session/pose_space.h"
#include "session/upload.h"

namespace posespace {

// The outline of a creature with three arms of different length about (100, 100), whose longest arm
// is turned by `lift` radians: star-shaped, and so simple, for lifts within +-0.6.
Points CreatureRing(double lift, int count = 60);

// The same turned as a whole by `turn` radians.
Points TurnedCreatureRing(double turn);

// A creature as an upload: rings, or a PNG file painted in one colour.
ShapeSource CreaturePolygon(double lift, int count = 60);
ShapeSource CreaturePicture(double lift, int size = 128);

// The drawing that such an upload becomes.
std::shared_ptr<const Drawing> DrawingOf(const std::string& id, const ShapeSource& source);

// What builds a pose space of creatures "pose0", "pose1", ... at default placements.
BuildInputs CreatureInputs(int count);

// The same of so many points that a build takes long enough to be met while it runs.
BuildInputs LongInputs();

}  // namespace posespace

#endif  // POSESPACE_TESTS_SESSION_SAMPLE_DRAWINGS_H_
