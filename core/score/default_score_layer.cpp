// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// Written by 'bpa train --source'; see the provenance below.
#include <bpa/core/score/score_layer.hpp>

namespace bpa {

// clang-format off
const ScoreLayer& default_score_layer() {
  static const ScoreLayer layer = {{{
      {-0.648317641, -0.0151264264, 1.32443265, 2.27381422},  // range
      {-0.554205011, -0.0316459976, 0.380260976, -0.193675585},  // normal
      {0.367177084, 0.999347197, 0.160409996, 0.236314967},  // agreeing
      {0, 0.524239024, -0.817433021, 1.61907499},  // free_space
      {0.175390722, 1, -0.359125008, 0.294761029},  // visibility
      {-0.512345679, -0, -0.350586353, 1.4203057},  // edge
      {0.064516129, 0.936440678, 1.14637792, 0.139563117},  // edge_support
      {0.126530612, 1, 0.322852275, -0.917765622},  // edge_visibility
      {0.102683184, 0.692012736, 0.607489863, -0.493038138},  // shape
      {0.0542018667, 0.720220163, -1.06013377, -1.17031298},  // relative_area
      {0, 0.506117909, -1.52092329, 0.402881753},  // unknown
      {0.118762986, 0.996370679, 0.0934963936, 0.144350172},  // explained
      {3.42388636, 7.26985509, 1.94226387, 0.737181523},  // evidence
      {-3.669061, -0.0648854915, 1.33352312, 2.12277214},  // range_evidence
      {-2.97620199, -0, -0.257955136, 0.527174352},  // edge_evidence
      {0, 0.729273644, -0.458005064, -0.844301644},  // background
      {5.53971568, 37.8991068, 2.38898424, -1.17452971},  // support
      {-0.949350376, -0.00145120533, 1.4745521, 1.65434145},  // edge_likelihood
      {-1, 0, 1.18093997, 0.97136402},  // occlusion_edge
      {-0.408899862, -0.00544512784, 0.357477569, 0.642529448},  // random_walk
      {-0.396355951, -0.00892704145, -0.1730839, 0.116953593},  // segment
      {-0.901918014, -0.0296094097, 0.791053055, 1.54253057},  // segment_affinity
  }}, -16.1220081,
  "bpa train, split test of train, 24 frames, seed 0"};
  return layer;
}
// clang-format on

}  // namespace bpa
