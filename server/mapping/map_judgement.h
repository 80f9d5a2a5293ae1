// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_MAPPING_MAP_JUDGEMENT_H_
#define POSESPACE_MAPPING_MAP_JUDGEMENT_H_

#include "mapping/outline_curve.h"
#include "mapping/outline_map.h"

namespace posespace {

// How unlike two outlines are along a finished map, whatever it was found by: in shape, thickness,
// place and, with a colour_weight above 0, colour, and how unevenly it stretches; each the mean
// along both.  To choose between maps that were found in different ways.
//
// A place that has moved far counts hardly more than one that has moved by 0.3 spreads: a tail
// that is raised in one drawing and hangs in the other says no more against a map than a tail that
// is a little elsewhere, but a body that lies elsewhere does.  A search for the least of this would
// be lost among starts, which only distance tells apart.
//
// Requires  curves whose thickness was measured, with colours when these are weighted.
// Returns   0 or more; less is better.  The same from b to a by the inverse map.
double JudgeMap(const OutlineCurve& a, const OutlineCurve& b, const OutlineMap& map,
                double colour_weight);

}  // namespace posespace

#endif  // POSESPACE_MAPPING_MAP_JUDGEMENT_H_
