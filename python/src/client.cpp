// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <chrono>
#include <mutex>
#include <thread>

#include <bpa/client.hpp>

#include "client/cli/convert.hpp"
#include "core/base/concat.hpp"
#include "core/io/pose_prior_file.hpp"
#include "python/src/bind.hpp"

namespace bpa::python {
namespace {

thread_local bool in_callback = false;

std::chrono::milliseconds milliseconds(double seconds) {
  if (!(seconds >= 0 && seconds <= 1e6)) {
    or_throw(invalid_argument("a time-out is ", seconds, " s; it must be between 0 and 1e6"));
  }
  return std::chrono::milliseconds(static_cast<std::int64_t>(1000 * seconds));
}

/// A function of Python for the SDK, whose threads call it and let go of it: they take the GIL.
auto callback(py::object function, auto convert) {
  const auto with_gil = [](py::object* held) {
    const py::gil_scoped_acquire gil;
    delete held;
  };
  const std::shared_ptr<py::object> shared(new py::object(std::move(function)), with_gil);
  return [shared, convert](const auto& value) {
    auto converted = convert(value);
    const py::gil_scoped_acquire gil;
    in_callback = true;
    try {
      (*shared)(std::move(converted));
    } catch (py::error_already_set& error) {
      error.discard_as_unraisable(*shared);  // Python prints the traceback
    }
    in_callback = false;
  };
}

/// Ends a client, which waits for its callbacks: without the GIL, and on no thread of its own.
void end(Client* client) {
  if (in_callback) return std::thread([client] { delete client; }).detach();
  const py::gil_scoped_release without_gil;
  delete client;
}

/// A connection. Calls that are under way keep the client, so that close() may come at any time.
class Connection {
 public:
  explicit Connection(const ClientOptions& options) {
    const py::gil_scoped_release without_gil;
    client_ = {new Client(or_throw(Client::connect(options))), &end};
  }

  void close() { client_.reset(); }

  /// What `call` of the client returns.
  template <class Call>
  auto operator()(const Call& call) const {
    const std::shared_ptr<Client> client = client_;
    if (!client) or_throw(Status(StatusCode::unavailable, "the client is closed"));
    const py::gil_scoped_release without_gil;
    return or_throw(call(*client));
  }

 private:
  std::shared_ptr<Client> client_;
};

std::recursive_mutex log_mutex;
bool logging = true;  // until Python ends; Fast DDS keeps the log function longer

void log(const std::string& text) {
  const std::lock_guard lock(log_mutex);
  if (!logging) return;
  const py::gil_scoped_acquire gil;
  py::module_::import("logging").attr("getLogger")("bpa").attr("warning")("%s", text);
}

void end_logging() {
  const py::gil_scoped_release without_gil;  // log() waits for it
  const std::lock_guard lock(log_mutex);
  logging = false;
}

std::unique_ptr<Connection> connect(int domain, const std::string& name, double timeout_s,
                                    double detect_timeout_s, bool localhost_only,
                                    const std::vector<std::string>& peers) {
  ClientOptions options;
  options.domain = domain;
  options.server_namespace = name;
  options.timeout = milliseconds(timeout_s);
  options.detect_timeout = milliseconds(detect_timeout_s);
  options.range_from_environment = !localhost_only;
  options.range = DiscoveryRange::localhost;
  options.peers = peers;
  options.log = &log;
  return std::make_unique<Connection>(options);
}

std::vector<ExpectedPose> expected_poses(const std::string& priors) {
  std::vector<ExpectedPose> out;
  for (const PosePrior& prior : or_throw(io::parse_pose_priors(priors, "priors"))) {
    out.push_back(cli::to_expected_pose(prior));
  }
  return out;
}

io::FrameResult detect(const Connection& self, const Images* images,
                       std::vector<std::string> models, int top_k, double budget_ms,
                       std::uint64_t seed, const std::string& priors, double timeout_s) {
  const DetectQuery query{std::move(models), top_k, budget_ms, seed, expected_poses(priors)};
  const auto wait = milliseconds(timeout_s);
  return cli::to_frame_result(self([&](Client& client) {
    return images == nullptr ? client.detect(query, wait)
                             : client.detect_in(images->view, query, wait);
  }));
}

py::list models(const Connection& self) {
  py::list out;
  for (const KnownModel& model : self([](Client& client) { return client.models(); })) {
    using py::literals::operator""_a;
    out.append(py::dict("name"_a = model.name, "number"_a = model.number,
                        "diameter"_a = model.diameter, "box_min"_a = model.box_min,
                        "box_max"_a = model.box_max, "point_count"_a = model.point_count));
  }
  return out;
}

/// A method that calls one of the client, which returns a Status.
template <class... Arguments>
auto method(Status (Client::*call)(Arguments...)) {
  return [call](const Connection& self, const std::decay_t<Arguments>&... arguments) {
    self([&](Client& client) { return (client.*call)(arguments...); });
  };
}

}  // namespace

void bind_client(py::module_& module) {
  py::module_::import("atexit").attr("register")(py::cpp_function(&end_logging));
  py::class_<Connection>(module, "Client")
      .def(py::init(&connect))
      .def("close", &Connection::close)
      .def("models", &models)
      .def("detect", &detect)
      .def("publish",
           [](const Connection& self, const Images& images, const std::string& priors) {
             const auto poses = expected_poses(priors);
             self([&](Client& client) { return client.publish_frame(images.view, poses); });
           })
      .def("subscribe",
           [](const Connection& self, py::object function) {
             const auto call = callback(std::move(function), &cli::to_frame_result);
             self([&](Client& client) { return client.subscribe(call); });
           })
      .def("tracks",
           [](const Connection& self, py::object function) {
             const auto call = callback(std::move(function), [](const TrackSet& set) {
               return io::track_json_line(cli::to_track_result(set));
             });
             self([&](Client& client) { return client.tracks(call); });
           })
      .def("rename_track", method(&Client::rename_track))
      .def("hold_track", method(&Client::hold_track))
      .def("forget_track", method(&Client::forget_track))
      .def("load_model", method(&Client::load_model))
      .def("unload_model", method(&Client::unload_model));
}

}  // namespace bpa::python
