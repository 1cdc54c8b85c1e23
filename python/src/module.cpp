// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/result/interpretation.hpp"
#include "python/src/bind.hpp"

PYBIND11_MODULE(_bpa, module) {
  namespace py = pybind11;
  py::register_exception_translator([](std::exception_ptr thrown) {
    try {
      if (thrown) std::rethrow_exception(thrown);
    } catch (const bpa::Failure& failure) {
      const py::object type = py::module_::import("bpa.error").attr("Error");
      const auto& [code, message] = failure.status();
      PyErr_SetObject(type.ptr(), py::make_tuple(message, bpa::to_string(code)).ptr());
    }
  });
  module.attr("version") = BPA_VERSION;
  module.attr("default_top_k") = bpa::kDefaultTopK;
  bpa::python::bind_images(module);
  bpa::python::bind_library(module);
  bpa::python::bind_detector(module);
  bpa::python::bind_client(module);
}
