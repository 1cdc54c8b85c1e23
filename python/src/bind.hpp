// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <bpa/types.hpp>

#include "core/base/failure.hpp"
#include "core/cloud/frame.hpp"
#include "core/io/image_file.hpp"
#include "core/model/library.hpp"
#include "core/score/score_layer.hpp"

// The extension bpa._bpa. It is private to the package: the .py files in bpa/ have its types and
// its words. A Failure becomes a bpa.Error. What takes long runs without the GIL.

namespace bpa::python {

namespace py = pybind11;

using WithoutGil = py::call_guard<py::gil_scoped_release>;

/// A rule that an array breaks: "NAME is ..., it must be RULE".
[[noreturn]] void refuse(const char* name, const py::object& value, const std::string& rule);

/// The elements of a C-contiguous array of T; null for any other object.
template <class T>
const T* elements(const py::object& value, const std::vector<py::ssize_t>& shape) {
  if (!py::isinstance<py::array_t<T, py::array::c_style>>(value)) return nullptr;
  const py::array array(value);
  const bool fits =
      std::equal(shape.begin(), shape.end(), array.shape(), array.shape() + array.ndim());
  return fits ? static_cast<const T*>(array.data()) : nullptr;
}

/// Moves values into an array, without a copy.
template <class T>
py::array_t<T> moved(std::vector<T> values, const std::vector<py::ssize_t>& shape) {
  auto owner = std::make_unique<std::vector<T>>(std::move(values));
  T* const data = owner->data();
  const py::capsule base(owner.release(), [](void* p) { delete static_cast<std::vector<T>*>(p); });
  return py::array_t<T>(shape, data, base);
}

/// (height, width, 3) uint8.
py::array_t<std::uint8_t> moved(io::ColorImage image);

/// The arrays of a frame, where they are.
struct Images {
  FrameView view;  ///< Points into the arrays.
  py::object depth, color, mask;
};

/// The frame as the detector takes it, which needs its own: depths are metres, and cleaned.
Frame to_frame(const FrameView& view);

/// Models, and what their folder says of the score.
struct Library {
  ModelLibrary models;
  score::ScoreLayers layers = score::default_score_layers();
  std::string folder;           ///< Where models were loaded from; empty: nowhere.
  std::set<std::string> added;  ///< Names of models that are not of `folder`.
};

void bind_images(py::module_& module);
void bind_library(py::module_& module);
void bind_detector(py::module_& module);
void bind_client(py::module_& module);

}  // namespace bpa::python
