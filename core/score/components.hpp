// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string_view>

#include "core/model/model_index.hpp"
#include "core/score/boundary_scores.hpp"
#include "core/score/evidence.hpp"
#include "core/score/likelihood.hpp"
#include "core/score/random_walk_score.hpp"

// Every score component of a placement, declared once, in the order in which they are measured:
// what tells most for its time is first. Layers, files, results, training, the explainer and the
// tests read this table: a new component is a function of the evidence and an entry here. Layers
// that do not know it yet count it as nothing until they are trained again.

namespace bpa::score {

/// When a component becomes known: in round two, in round three, when rivals are compared, or when
/// a first interpretation says what else is there.
enum class Round : std::uint8_t { two, three, rivals, others };

/// The images that a component needs. A grey image has outlines and no colours.
enum class Needs : std::uint8_t {
  depth,    ///< Nothing beside depth.
  outline,  ///< A colour image of the frame.
  colors    ///< Colours of the frame and of the model.
};

struct ComponentType {
  std::string_view name;
  std::string_view unit;
  double min, max;  ///< Values are in this range.
  Round round;
  bool learned;                  ///< False: reported, but no part of the score.
  double (*measure)(Evidence&);  ///< kNotKnown where it has no value.
  std::string_view meaning;
  Needs needs = Needs::depth;
  bool rises = false;  ///< More never speaks against a placement: training keeps the curve rising.
};

constexpr auto kScoreComponents = std::to_array<ComponentType>({
    {"range", "log-likelihood", -1, 0, Round::two, true,
     [](Evidence& e) -> double { return e.surface().range; },
     "Depth differences, weighted by visibility.", Needs::depth, true},
    {"normal", "log-likelihood", -1, 0, Round::two, true,
     [](Evidence& e) -> double { return e.surface().normal; },
     "Differences of normals, weighted by visibility.", Needs::depth, true},
    {"agreeing", "share", 0, 1, Round::two, true,
     [](Evidence& e) -> double { return e.surface().agreeing; },
     "Visible points on the observed surface."},
    {"free_space", "share", 0, 1, Round::two, true,
     [](Evidence& e) -> double { return e.surface().free_space; },
     "Visible points in front of the observed surface, by seven standard deviations of depth."},
    {"visibility", "share", 0, 1, Round::two, true,
     [](Evidence& e) -> double { return e.surface().visibility; },
     "Facing model points that are neither hidden nor outside the image.", Needs::depth, true},
    {"edge", "log-likelihood", -1, 0, Round::two, true,
     [](Evidence& e) -> double { return e.surface().edge; },
     "Observed surface that goes on beyond model edges."},
    {"edge_support", "share", 0, 1, Round::two, true,
     [](Evidence& e) -> double { return e.surface().edge_support; },
     "Model edge points where the observed surface ends."},
    {"edge_visibility", "share", 0, 1, Round::two, true,
     [](Evidence& e) -> double { return e.surface().edge_visibility; },
     "Model edge points that are neither hidden nor outside the image."},
    {"shape", "root of a share", 0, 0.71, Round::two, true,
     [](Evidence& e) -> double { return std::sqrt(std::max(0.0, e.surface().shape)); },
     "Spread of the normals of agreeing points; 0 for one flat face."},
    {"relative_area", "squared diameters", 0, 4, Round::two, true,
     [](Evidence& e) -> double { return e.surface().relative_area; },
     "Explained surface."},
    {"unknown", "share", 0, 1, Round::two, true,
     [](Evidence& e) -> double { return e.surface().unknown; },
     "Facing model points where no depth is known."},
    {"explained", "ratio", 0, 10, Round::two, true,
     [](Evidence& e) -> double { return e.surface().explained_pixels / std::max(1.0, e.surface().expected_pixels); },
     "Explained pixels, of those the whole model would cover.", Needs::depth, true},
    {"evidence", "log pixels", 0, 14, Round::two, true,
     [](Evidence& e) -> double { return e.surface().evidence(); },
     "Logarithm of the support."},
    {"range_evidence", "log-likelihood x log pixels", -14, 0, Round::two, true,
     [](Evidence& e) -> double { return e.surface().range * e.surface().evidence(); },
     "Component range times evidence."},
    {"edge_evidence", "log-likelihood x log pixels", -14, 0, Round::two, true,
     [](Evidence& e) -> double { return e.surface().edge * e.surface().evidence(); },
     "Component edge times evidence."},
    {"background", "share", 0, 1, Round::two, true,
     [](Evidence& e) -> double { return e.surface().background; },
     "Agreeing points on labelled background."},
    {"support", "root of pixels", 0, 600, Round::two, true,
     [](Evidence& e) -> double { return std::sqrt(std::max(0.0, e.surface().support())); },
     "Root of the pixels that speak for the placement."},
    {"below", "share", 0, 1, Round::three, true,
     [](Evidence& e) -> double { return e.resting().below; },
     "Model points beneath a plane that is seen there."},
    {"gap", "metres", -0.05, 0.2, Round::three, true,
     [](Evidence& e) -> double { return e.resting().gap; },
     "From the largest plane to the lowest point, beyond 1 cm."},
    {"balance", "diameters", -2, 2, Round::three, true,
     [](Evidence& e) -> double { return e.resting().balance; },
     "How far the centre is inside of what rests on the plane; negative: it would fall."},
    {"silhouette", "share", 0, 1, Round::three, true,
     [](Evidence& e) -> double { return e.silhouette().on; },
     "Strength of the colour gradients across the outline.", Needs::outline},
    {"silhouette_contrast", "share", -1, 1, Round::three, true,
     [](Evidence& e) -> double { return e.silhouette().contrast; },
     "The same less that beside the outline.", Needs::outline},
    {"color", "log-likelihood", -1, 0, Round::three, true,
     [](Evidence& e) -> double { return e.colors().likelihood; },
     "Colours of the surface, under the frame's light.", Needs::colors},
    {"tint", "CIELAB", 0, 200, Round::three, true,
     [](Evidence& e) -> double { return e.colors().tint; },
     "Colour shift of the whole placement.", Needs::colors},
    {"exposure", "log of the cube root of light", -2.4, 2.4, Round::three, false,
     [](Evidence& e) -> double { return e.colors().exposure; },
     "Light of the whole placement, frame to model.", Needs::colors},
    {"texture", "log-likelihood ratio", -5, 10, Round::three, true,
     [](Evidence& e) -> double { return e.texture().log_ratio; },
     "Mean over pixels: the model's pattern against a surface of one colour.", Needs::colors},
    {"texture_evidence", "log-likelihood ratio", -1e5, 1e5, Round::three, true,
     [](Evidence& e) -> double { return e.texture().total; },
     "Sum over independent pixels of the same.", Needs::colors},
    {"segment", "log-likelihood", -1, 0, Round::three, true,
     [](Evidence& e) -> double { return segment_score(e.segments()); },
     "Distance of the touched super-pixels from the model."},
    {"segment_affinity", "log-likelihood", -1, 0, Round::three, true,
     [](Evidence& e) -> double { return segment_affinity_score(e.scene().segmentation, e.segments()); },
     "Super-pixels of one object should be explained together."},
    {"edge_likelihood", "log-likelihood", -1, 0, Round::three, true,
     [](Evidence& e) -> double { return edge_likelihood_score(e.scene().image, e.edges(), e.model(), e.pose()); },
     "Predicted range edges in the edge image."},
    {"occlusion_edge", "log-likelihood", -1, 0, Round::three, true,
     [](Evidence& e) -> double { return occlusion_edge_score(e.scene().image, e.edges(), e.predicted()); },
     "Edges where the placement begins to be hidden."},
    {"random_walk", "log-likelihood", -1, 0, Round::three, true,
     [](Evidence& e) -> double { return random_walk_score(e.scene().image, e.edges(), e.model(), e.pose(), e.predicted()); },
     "Ends of random walks that do not cross edges."},
    {"fpfh", "log-likelihood", -1, 0, Round::three, true,
     [](Evidence& e) -> double { return fpfh_score(e.scene().surface, e.scene().keypoints, e.scene().fpfh, e.places(), e.pose()); },
     "FPFH features that lie on the model."},
    {"rivals", "log-likelihood", -500, 0, Round::rivals, true,
     [](Evidence&) -> double { return kNotKnown; },
     "Depth: log-likelihood behind the best pose in the same place; see behind_best()."},
    {"rivals_color", "log-likelihood", -500, 0, Round::rivals, true,
     [](Evidence&) -> double { return kNotKnown; },
     "The same of colours.", Needs::colors},
    {"hidden_by_unknown", "share", 0, 1, Round::others, true,
     [](Evidence&) -> double { return kNotKnown; },
     "Facing model points that are hidden by what no other placement explains."},
    {"left_over", "share", 0, 1, Round::others, true,
     [](Evidence&) -> double { return kNotKnown; },
     "Pixels of its super-pixels that neither it nor another placement explains."},
    {"copies", "log ratio", -7, 7, Round::others, true,
     [](Evidence&) -> double { return kNotKnown; },
     "Confident detections of this model, to those of the commonest other; unknown below two."},
    {"relative_exposure", "log of the cube root of light", -4.8, 4.8, Round::others, true,
     [](Evidence&) -> double { return kNotKnown; },
     "Component exposure less the median of the other placements.", Needs::colors},
    {"explained_pixels", "pixels", 0, 77000, Round::two, false,
     [](Evidence& e) -> double { return e.surface().explained_pixels; },
     "Observed pixels on the model, reduced image."},
    {"expected_pixels", "pixels", 0, 1e6, Round::two, false,
     [](Evidence& e) -> double { return e.surface().expected_pixels; },
     "Pixels the model would cover were nothing in front of it."},
    {"explained_area", "m^2", 0, 9, Round::two, false,
     [](Evidence& e) -> double { return e.surface().explained_area; },
     "Explained surface."},
});

/// The values of a placement's components, in the order of the table; kNotKnown where unknown.
using ScoreValues = std::array<double, kScoreComponents.size()>;

/// The place of a component in the table, by a name that must be there.
consteval std::size_t component(std::string_view name) {
  std::size_t i = 0;
  while (kScoreComponents[i].name != name) ++i;
  return i;
}

/// The components that are known up to `last`; the others are kNotKnown.
ScoreValues measure(Evidence& evidence, Round last);

}  // namespace bpa::score
