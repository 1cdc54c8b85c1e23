// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>

#include <pybind11/eigen.h>

#include "core/base/concat.hpp"
#include "core/cloud/undistortion.hpp"
#include "core/geometry/lens.hpp"
#include "core/io/camera_file.hpp"
#include "python/src/bind.hpp"

namespace bpa::python {
namespace {

using Intrinsics = std::array<double, 4>;  // fx, fy, cx, cy
using Size = std::array<int, 2>;           // width, height

// "float64 of shape (480, 640), not C-contiguous", or "a list".
std::string described(const py::object& value) {
  if (!py::isinstance<py::array>(value)) {
    return "a " + value.get_type().attr("__name__").cast<std::string>();
  }
  const std::string type = py::str(value.attr("dtype")), shape = py::str(value.attr("shape"));
  const bool packed = value.attr("flags").attr("c_contiguous").cast<bool>();
  return type + " of shape " + shape + (packed ? "" : ", not C-contiguous");
}

const std::uint8_t* mask_of(const py::object& mask, const std::vector<py::ssize_t>& shape) {
  if (mask.is_none()) return nullptr;
  if (const bool* flags = elements<bool>(mask, shape)) {
    return reinterpret_cast<const std::uint8_t*>(flags);
  }
  const std::uint8_t* const bytes = elements<std::uint8_t>(mask, shape);
  if (bytes == nullptr) refuse("mask", mask, "a bool or uint8 array of the shape of depth");
  return bytes;
}

Images images_of(const py::object& depth, const py::object& color, const py::object& mask,
                 const Intrinsics& camera, const Size& size, const std::array<int, 4>& roi,
                 std::int64_t stamp_ns, const std::string& frame_id) {
  Images images{{}, depth, color, mask};
  FrameView& view = images.view;
  std::vector<py::ssize_t> shape;
  if (py::isinstance<py::array>(depth)) {
    const py::array array(depth);
    shape.assign(array.shape(), array.shape() + array.ndim());
  }
  if (shape.size() == 2) {
    view.depth_mm = elements<std::uint16_t>(depth, shape);
    view.depth_m = elements<float>(depth, shape);
  }
  if (view.depth_mm == nullptr && view.depth_m == nullptr) {
    refuse("depth", depth,
           "a C-contiguous array of shape (height, width), uint16 in millimetres or float32 in "
           "metres");
  }
  view.height = static_cast<int>(shape[0]);
  view.width = static_cast<int>(shape[1]);
  if (size != Size{} && size != Size{view.width, view.height}) {
    or_throw(invalid_argument(concat("depth has ", view.width, " x ", view.height,
                                     " pixels; the camera has ", size[0], " x ", size[1])));
  }
  view.mask = mask_of(mask, shape);
  shape.push_back(3);
  if (!color.is_none()) view.rgb = elements<std::uint8_t>(color, shape);
  if (!color.is_none() && view.rgb == nullptr) {
    refuse("color", color,
           concat("a C-contiguous uint8 array of shape (", view.height, ", ", view.width,
                  ", 3), rgb"));
  }
  view.fx = camera[0], view.fy = camera[1];
  view.cx = camera[2], view.cy = camera[3];
  view.roi = roi;
  view.stamp_ns = stamp_ns;
  view.frame_id = frame_id;
  return images;
}

py::tuple read_frame(const std::string& depth, const std::string& color,
                     const std::string& camera) {
  const io::CameraFile file = or_throw(io::read_camera(camera));
  const Lens lens = or_throw(lens_of(file.distortion_model, file.distortion), camera);
  Frame frame = or_throw(io::read_frame(depth, color, file.camera, file.depth_scale_mm));
  undistort(lens, frame);
  const auto& [width, height, fx, fy, cx, cy] = frame.camera;
  py::object colors = py::none();
  if (!color.empty()) colors = moved(io::ColorImage{width, height, std::move(frame.color)});
  return py::make_tuple(moved(std::move(frame.depth), {height, width}), colors,
                        py::make_tuple(fx, fy, cx, cy, width, height));
}

}  // namespace

void refuse(const char* name, const py::object& value, const std::string& rule) {
  throw Failure(invalid_argument(concat(name, " is ", described(value), "; it must be ", rule)));
}

py::array_t<std::uint8_t> moved(io::ColorImage image) {
  return moved(std::move(image.pixels), {image.height, image.width, 3});
}

Frame to_frame(const FrameView& view) {
  Frame frame;
  frame.camera = {view.width, view.height, view.fx, view.fy, view.cx, view.cy};
  const std::size_t size = static_cast<std::size_t>(view.width) * view.height;
  if (view.depth_m != nullptr) {
    frame.depth.assign(view.depth_m, view.depth_m + size);
  } else {
    frame.depth.resize(size);
    std::transform(view.depth_mm, view.depth_mm + size, frame.depth.begin(),
                   [](std::uint16_t mm) { return static_cast<float>(mm * 0.001); });
  }
  if (view.rgb != nullptr) frame.color.assign(view.rgb, view.rgb + 3 * size);
  if (view.mask != nullptr) frame.mask.assign(view.mask, view.mask + size);
  frame.roi = {view.roi[0], view.roi[1], view.roi[2], view.roi[3]};
  frame.stamp_ns = view.stamp_ns;
  frame.frame_id = view.frame_id;
  clean_depth(frame);
  return frame;
}

void bind_images(py::module_& module) {
  py::class_<Images>(module, "Images").def(py::init(&images_of));
  module.def("read_frame", &read_frame);
  module.def("matrix",
             [](const std::array<double, 4>& wxyz, const std::array<double, 3>& translation) {
               Eigen::Matrix<double, 4, 4, Eigen::RowMajor> matrix = Eigen::Matrix4d::Identity();
               const Eigen::Quaterniond rotation(wxyz[0], wxyz[1], wxyz[2], wxyz[3]);
               matrix.topLeftCorner<3, 3>() = rotation.toRotationMatrix();
               matrix.topRightCorner<3, 1>() = Eigen::Vector3d::Map(translation.data());
               return matrix;
             });
}

}  // namespace bpa::python
