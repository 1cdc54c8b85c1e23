// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "core/io/image_file.hpp"

namespace bpa::draw {

/// Points (x, y), drawn as a line with dots. Both vectors have one length.
struct Series {
  std::string name;
  std::vector<double> x;
  std::vector<double> y;
  std::vector<std::string> notes = {};  ///< Beside the points if there is room; x's length or less.
};

struct PlotAxes {
  std::string title, x_name, y_name;
  double x_min = 0, x_max = 1, y_min = 0, y_max = 1;  ///< A maximum of 0 fits the data.
  bool diagonal = false;  ///< Also a thin line from corner to corner; fitted axes become equal.
};

/// 640x480 rgb. Points outside the axes are left out.
io::ColorImage line_plot(const PlotAxes& axes, const std::vector<Series>& series);

/// Stacked bars: counts in equal bins over [x_min, x_max], a colour for each series. y fits them.
io::ColorImage histogram_plot(const PlotAxes& axes, const std::vector<std::string>& names,
                              const std::vector<std::vector<int>>& counts);

/// One horizontal bar for each name, of length values[i] in [0, 1], with notes[i] at its right end.
io::ColorImage bar_plot(const std::string& title, const std::vector<std::string>& names,
                        const std::vector<double>& values, const std::vector<std::string>& notes);

}  // namespace bpa::draw
