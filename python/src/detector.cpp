// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/pipeline/detector.hpp"

#include "core/base/concat.hpp"
#include "core/base/stopwatch.hpp"
#include "core/draw/annotate.hpp"
#include "core/io/options_yaml.hpp"
#include "core/io/pose_prior_file.hpp"
#include "core/io/results.hpp"
#include "python/src/bind.hpp"

namespace bpa::python {
namespace {

/// `settings` are assignments such as "surface.max_range_m=2.5".
std::unique_ptr<Detector> make_detector(const Library& library, const std::string& file,
                                        const std::vector<std::string>& settings) {
  DetectorOptions options;
  if (!file.empty()) options = or_throw(load_detector_options(file));
  const io::OptionsReading reading{options_of(options), "", {}};
  for (const std::string& setting : settings) or_throw(io::set_option(setting, reading));
  return std::make_unique<Detector>(std::make_shared<ModelLibrary>(library.models), options,
                                    library.layers);
}

io::FrameResult detect(const Detector& detector, const Images& images, DetectRequest request,
                       const std::string& priors, const io::FrameResult* after,
                       const py::object& on_round) {
  if (!on_round.is_none()) {
    request.on_round = [&on_round](const SceneInterpretations& so_far) {
      const py::gil_scoped_acquire gil;
      on_round(io::FrameResult{so_far, 0, 0, 0, {}});
    };
  }
  const py::gil_scoped_release without_gil;
  request.priors = or_throw(io::parse_pose_priors(priors, "priors"));
  if (after != nullptr) request.expected = expected_after(*after);
  const Stopwatch watch;
  io::FrameResult result{or_throw(detector.detect(to_frame(images.view), request)), 0, 0, 0, {}};
  result.seconds = watch.seconds();
  return result;
}

py::array_t<std::uint8_t> annotated(const io::FrameResult& result, const Library& library,
                                    const Images& images, int rank) {
  const auto ranks = static_cast<int>(result.interpretations.size());
  if (rank < 1 || rank > ranks) {
    or_throw(invalid_argument("rank is ", rank, "; the result has 1 to ", ranks));
  }
  const ModelLibrary models = library.models;
  const auto drawn = [&] {
    const py::gil_scoped_release without_gil;
    const Frame frame = to_frame(images.view);
    or_throw(validate(frame));
    return draw::annotate(frame, result.interpretations[rank - 1], models);
  };
  return moved(drawn());
}

}  // namespace

void bind_detector(py::module_& module) {
  py::class_<io::FrameResult>(module, "Found")
      .def("json", &io::result_json_line, WithoutGil())
      .def("draw", &annotated);
  py::class_<Detector>(module, "Detector")
      .def(py::init(&make_detector))
      .def("detect",
           [](const Detector& self, const Images& images, std::vector<std::string> models,
              int top_k, double budget_ms, std::uint64_t seed, int num_threads,
              const std::string& priors, const io::FrameResult* after, const py::object& on_round) {
             DetectRequest request{.models = std::move(models),
                                   .top_k = top_k,
                                   .budget_ms = budget_ms,
                                   .seed = seed,
                                   .num_threads = num_threads};
             return detect(self, images, std::move(request), priors, after, on_round);
           });
}

}  // namespace bpa::python
