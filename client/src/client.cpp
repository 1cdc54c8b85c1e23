// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

#include <bpa/client.hpp>

#include "client/src/convert.hpp"
#include "client/src/join.hpp"
#include "core/base/guarded.hpp"
#include "idl/wire/messages.hpp"
#include "idl/wire/middleware.hpp"
#include "idl/wire/participant.hpp"
#include "idl/wire/publisher.hpp"
#include "idl/wire/service.hpp"
#include "idl/wire/status.hpp"
#include "idl/wire/subscriber.hpp"
#include "idl/wire/task_thread.hpp"

namespace bpa {
namespace {

namespace msgs = wire::bpa_msgs;
using Milliseconds = std::chrono::milliseconds;

constexpr std::size_t kMaxWaitingCallbacks = 100;

Result<wire::Discovery> discovery_of(const ClientOptions& options) {
  auto environment = wire::discovery_from_environment();
  if (!environment.ok()) return environment.status();
  wire::Discovery discovery = *environment;
  if (options.domain > 232 || options.domain < -1) {
    return invalid_argument("domain is " + std::to_string(options.domain) +
                            "; it must be between 0 and 232, or -1 for ROS_DOMAIN_ID");
  }
  if (options.domain >= 0) discovery.domain_id = options.domain;
  if (!options.range_from_environment) {
    discovery.static_peers.clear();
    discovery.range = options.range == DiscoveryRange::subnet      ? wire::DiscoveryRange::subnet
                      : options.range == DiscoveryRange::localhost ? wire::DiscoveryRange::localhost
                                                                   : wire::DiscoveryRange::off;
  }
  discovery.static_peers.insert(discovery.static_peers.end(), options.peers.begin(),
                                options.peers.end());
  return discovery;
}

/// A failure of the request itself, or the one that the server answered.
template <class Response>
Status outcome(const Result<Response>& response) {
  if (!response.ok()) return response.status();
  if (response->success) return {};
  Status status = wire::to_status(response->status);
  if (status.ok()) status = Status(StatusCode::internal, "the server refused without a reason");
  return status;
}

/// No exception may leave the SDK; what is left over (no memory, no thread) becomes a Status.
template <class Call>
auto guarded(const Call& call) {
  return bpa::guarded("the SDK failed", call);
}

}  // namespace

Result<wire::Participant> sdk::join(const ClientOptions& options) {
  if (options.timeout <= Milliseconds(0)) {
    return invalid_argument("timeout is " + std::to_string(options.timeout.count()) +
                            " ms; it must be positive");
  }
  auto discovery = discovery_of(options);
  if (!discovery.ok()) return discovery.status();
  wire::ParticipantOptions seat;
  seat.node = {options.server_namespace, "client"};
  seat.discovery = *discovery;
  seat.security = {options.keystore, options.enclave};
  if (options.log) {
    seat.log = [hook = options.log](LogLevel level, std::string_view text) {
      if (level != LogLevel::debug) hook(std::string(text));
    };
  }
  return wire::Participant::create(std::move(seat));
}

struct Client::Impl {
  /// A service, or why our enclave may not call it.
  template <class Service>
  class Caller {
   public:
    /// Other failures than a lack of permission are given back.
    Status open(const wire::Participant& ours, const char* service) {
      client_ = wire::ServiceClient<Service>::create(ours, service);
      return client_.status().code == StatusCode::unsupported ? Status() : client_.status();
    }
    void refuse(const Status& reason) { client_ = reason; }
    Result<typename Service::Response> call(const typename Service::Request& request,
                                            Milliseconds timeout) const {
      if (!client_.ok()) return client_.status();
      return client_.value().call(request, timeout);
    }
    const Result<wire::ServiceClient<Service>>& client() const { return client_; }

   private:
    Result<wire::ServiceClient<Service>> client_{Status(StatusCode::internal, "not made")};
  };

  ClientOptions options;
  wire::Participant participant;
  Caller<msgs::Detect> detect = {};
  Caller<msgs::DetectViews> detect_views = {};
  Caller<msgs::ListModels> list_models = {};
  Caller<msgs::LoadModel> load_model = {};
  Caller<msgs::UnloadModel> unload_model = {};
  Caller<msgs::GetStatus> get_status = {};
  Caller<msgs::Record> record = {};
  Caller<msgs::RenameTrack> rename_track = {};
  Caller<msgs::HoldTrack> hold_track = {};
  Caller<msgs::ForgetTrack> forget_track = {};

  // Those below are made on first use.
  std::mutex mutex = {};
  std::optional<wire::Publisher<msgs::RgbdFrame>> frames = {};
  bool listened = false;  ///< The server has told that it takes our frames.
  /// So that a slow callback never holds up DDS.
  wire::TaskThread callbacks{{}, kMaxWaitingCallbacks};
  // Last: they give the thread above work until they are destroyed.
  std::optional<wire::Subscriber<msgs::SceneInterpretations>> results = {};
  std::optional<wire::Subscriber<wire::sensor_msgs::Image>> images = {};
  std::optional<wire::Subscriber<msgs::RgbdFrame>> others_frames = {};
  std::optional<wire::Subscriber<msgs::Tracks>> tracks = {};

  static Result<std::unique_ptr<Impl>> create(const ClientOptions& options);
  Result<Recording> call_record(const msgs::Record_Request& request) const;

  Result<DetectionSet> search(msgs::Detect_Request request, const DetectQuery& query,
                              Milliseconds asked) const;
  /// Puts what both kinds of searches ask into a request but for its priors.
  template <class Request>
  static Status ask(const DetectQuery& query, Request& request);
  /// Has call() run on the callback thread with convert(message) for each message of the topic.
  /// Replaces the subscription in `slot`. Waits for a publisher if `wait`.
  template <class Message, class Convert, class Call>
  Status subscribe(std::optional<wire::Subscriber<Message>>& slot, const char* topic,
                   const wire::Qos& qos, bool wait, Convert convert, Call call);
  /// Makes `frames` unless it is there.
  Status make_frames();
  /// Waits until the server takes `frames`.
  Status wait_for_listener();
};

Result<std::unique_ptr<Client::Impl>> Client::Impl::create(const ClientOptions& options) {
  auto participant = sdk::join(options);
  if (!participant.ok()) return participant.status();
  std::unique_ptr<Impl> impl(new Impl{options, std::move(participant).value()});
  Status status = impl->get_status.open(impl->participant, "get_status");
  const Status forbidden = impl->get_status.client().status();
  const auto make = [&](auto& caller, const char* service) {
    if (!forbidden.ok()) return caller.refuse(forbidden);
    if (status.ok()) status = caller.open(impl->participant, service);
  };
  make(impl->detect, "detect");
  make(impl->detect_views, "detect_views");
  make(impl->list_models, "list_models");
  make(impl->load_model, "load_model");
  make(impl->unload_model, "unload_model");
  make(impl->record, "record");
  make(impl->rename_track, "rename_track");
  make(impl->hold_track, "hold_track");
  make(impl->forget_track, "forget_track");
  if (!status.ok()) return status;
  return impl;
}

template <class Message, class Convert, class Call>
Status Client::Impl::subscribe(std::optional<wire::Subscriber<Message>>& slot, const char* topic,
                               const wire::Qos& qos, bool wait, Convert convert, Call call) {
  const std::lock_guard<std::mutex> lock(mutex);
  slot.reset();
  auto subscriber = wire::Subscriber<Message>::create(
      participant, topic, {qos},
      [this, convert, call = std::move(call)](Message&& message, const wire::SampleMeta&) {
        using Value = std::decay_t<decltype(convert(std::move(message)))>;
        auto value = std::make_shared<const Value>(convert(std::move(message)));
        // What the user's function throws is the user's: it ends the program.
        callbacks.run_at(wire::TaskThread::Clock::now(),
                         [call, value]() noexcept { call(*value); });
      });
  if (!subscriber.ok()) return subscriber.status();
  slot.emplace(std::move(subscriber).value());
  if (wait) slot->wait_for_matched(options.timeout);
  return {};
}

template <class Request>
Status Client::Impl::ask(const DetectQuery& query, Request& request) {
  if (query.top_k < 0 || query.top_k > 100) {
    return invalid_argument("top_k is " + std::to_string(query.top_k) +
                            "; it must be between 1 and 100, or 0 for the server's setting");
  }
  request.models = query.models;
  request.top_k = static_cast<std::uint32_t>(query.top_k);
  request.time_budget_ms = query.budget_ms;
  request.seed = query.seed;
  return {};
}

Result<DetectionSet> Client::Impl::search(msgs::Detect_Request request, const DetectQuery& query,
                                          Milliseconds asked) const {
  if (Status status = ask(query, request); !status.ok()) return status;
  const Milliseconds timeout = asked > Milliseconds(0) ? asked : options.detect_timeout;
  auto priors = sdk::to_messages(query.priors);
  if (!priors.ok()) return priors.status();
  request.frame.priors = std::move(priors).value();
  // The server gives up earlier than we do, so that it can say why.
  const auto total_ms = static_cast<double>(timeout.count());
  request.timeout_ms = std::max(1.0, total_ms - std::clamp(0.25 * total_ms, 50.0, 1000.0));
  const auto response = detect.call(request, timeout);
  if (Status status = outcome(response); !status.ok()) return status;
  DetectionSet found = sdk::to_detections(response->result);
  found.queue_position = static_cast<int>(response->queue_position);
  return found;
}

Status Client::Impl::make_frames() {
  const std::lock_guard<std::mutex> lock(mutex);
  if (frames) return {};
  auto publisher =
      wire::Publisher<msgs::RgbdFrame>::create(participant, "frames", {wire::qos::frames()});
  if (publisher.ok()) frames.emplace(std::move(publisher).value());
  return publisher.status();
}

// That we know the server does not mean that it knows us already, and what is sent before the two
// have exchanged their first heartbeats (every 100 ms) is lost. So the server is asked once, and
// given one more heartbeat; again after it was away.
Status Client::Impl::wait_for_listener() {
  const auto end = std::chrono::steady_clock::now() + options.timeout;
  {
    const std::lock_guard<std::mutex> lock(mutex);
    if (listened && frames->matched_count() > 0) return {};
    listened = false;
  }
  const Status silence(StatusCode::unavailable,
                       "no server listens to " + frames->topic() + " within " +
                           std::to_string(options.timeout.count()) + " ms");
  if (!frames->wait_for_matched(options.timeout)) return silence;
  while (std::chrono::steady_clock::now() < end) {
    std::this_thread::sleep_for(Milliseconds(50));
    const auto response = get_status.call({}, options.timeout);
    if (Status status = outcome(response); !status.ok()) return status;
    if (response->frame_publishers == 0) continue;
    std::this_thread::sleep_for(Milliseconds(100));
    const std::lock_guard<std::mutex> lock(mutex);
    listened = true;
    return {};
  }
  return silence;
}

Client::Client(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Client::Client(Client&&) noexcept = default;
Client& Client::operator=(Client&&) noexcept = default;
Client::~Client() = default;

Result<Client> Client::connect(const ClientOptions& options) {
  return guarded([&]() -> Result<Client> {
    auto impl = Impl::create(options);
    if (!impl.ok()) return impl.status();
    const auto& get_status = (*impl)->get_status.client();
    if (get_status.ok() && !get_status.value().wait_for_service(options.timeout)) {
      std::string text =
          "no bpa-server answers as " + get_status.value().name() + " in domain " +
          std::to_string((*impl)->participant.domain_id()) + " within " +
          std::to_string(options.timeout.count()) +
          " ms; is it running, with this namespace, domain, discovery range and keystore?";
      for (const auto& note : wire::check_middleware(options.range_from_environment)) {
        text += "\n" + wire::line_of(note);
      }
      return Status(StatusCode::unavailable, text);
    }
    return Client(std::move(impl).value());
  });
}

Result<std::vector<KnownModel>> Client::models() {
  return guarded([&]() -> Result<std::vector<KnownModel>> {
    const auto response = impl_->list_models.call({}, impl_->options.timeout);
    if (Status status = outcome(response); !status.ok()) return status;
    std::vector<KnownModel> models;
    for (const auto& model : response->models) models.push_back(sdk::to_model(model));
    return models;
  });
}

Result<DetectionSet> Client::detect(const DetectQuery& query, Milliseconds timeout) {
  return guarded([&] { return impl_->search({}, query, timeout); });
}

Result<DetectionSet> Client::detect_in(const FrameView& frame, const DetectQuery& query,
                                       Milliseconds timeout) {
  return guarded([&]() -> Result<DetectionSet> {
    if (Status status = sdk::check(frame); !status.ok()) return status;
    msgs::Detect_Request request;
    request.has_frame = true;
    request.frame = sdk::to_owned_message(frame);
    return impl_->search(std::move(request), query, timeout);
  });
}

Result<SceneDetections> Client::detect_views(const std::vector<PosedFrame>& views,
                                             const std::string& fixed_frame,
                                             const DetectQuery& query, Milliseconds timeout) {
  return guarded([&]() -> Result<SceneDetections> {
    msgs::DetectViews_Request request;
    if (Status status = impl_->ask(query, request); !status.ok()) return status;
    for (const PosedFrame& view : views) {
      if (Status status = sdk::check(view.frame); !status.ok()) return status;
      request.frames.push_back(sdk::to_owned_message(view.frame));
      request.scene_from_camera.push_back(sdk::to_message(view.scene_from_camera));
    }
    auto priors = sdk::to_messages(query.priors);
    if (!priors.ok()) return priors.status();
    if (!views.empty()) request.frames.front().priors = std::move(priors).value();
    request.fixed_frame = fixed_frame;
    const auto response = impl_->detect_views.call(
        request, timeout > Milliseconds(0) ? timeout : impl_->options.detect_timeout);
    if (Status status = outcome(response); !status.ok()) return status;
    SceneDetections result{sdk::to_detections(response->result), {}, response->warnings};
    for (const auto& pose : response->scene_from_camera) {
      result.scene_from_camera.push_back(sdk::to_pose(pose));
    }
    return result;
  });
}

Status Client::publish_frame(const FrameView& frame, const std::vector<ExpectedPose>& priors) {
  return guarded([&]() -> Status {
    if (Status status = sdk::check(frame); !status.ok()) return status;
    if (Status status = impl_->make_frames(); !status.ok()) return status;
    if (Status status = impl_->wait_for_listener(); !status.ok()) return status;
    auto known = sdk::to_messages(priors);
    if (!known.ok()) return known.status();
    msgs::RgbdFrameView message = sdk::to_message(frame);
    message.priors = std::move(known).value();
    return impl_->frames->publish(message);
  });
}

Status Client::subscribe(std::function<void(const DetectionSet&)> on_result) {
  return guarded([&] {
    return impl_->subscribe(impl_->results, "interpretations", wire::qos::results(), true,
                            sdk::to_detections, std::move(on_result));
  });
}

Status Client::subscribe_frames(std::function<void(const FrameView&)> on_frame) {
  const auto convert = [](msgs::RgbdFrame&& message) { return std::move(message); };
  const auto call = [on_frame = std::move(on_frame)](const msgs::RgbdFrame& frame) {
    const auto view = sdk::to_view(frame);
    if (view.ok()) on_frame(*view);
  };
  // Over UDP: a second reader of shared memory gets nothing from Fast DDS 2.9.1.
  return guarded([&] {
    return impl_->subscribe(impl_->others_frames, "frames", wire::qos::frames(), false, convert,
                            call);
  });
}

Status Client::subscribe_annotated(std::function<void(const AnnotatedImage&)> on_image) {
  const auto call = [on_image = std::move(on_image)](const Result<AnnotatedImage>& image) {
    if (image.ok()) on_image(*image);
  };
  return guarded([&] {
    return impl_->subscribe(impl_->images, "annotated", wire::qos::results(), true, sdk::to_image,
                            call);
  });
}

Status Client::tracks(std::function<void(const TrackSet&)> on_tracks) {
  return guarded([&] {
    return impl_->subscribe(impl_->tracks, "track_states", wire::qos::results(), true,
                            sdk::to_tracks, std::move(on_tracks));
  });
}

Status Client::rename_track(const std::string& track, const std::string& name) {
  return guarded([&] {
    return outcome(impl_->rename_track.call({track, name}, impl_->options.timeout));
  });
}

Status Client::hold_track(const std::string& track, bool hold) {
  return guarded([&] {
    return outcome(impl_->hold_track.call({track, hold}, impl_->options.timeout));
  });
}

Status Client::forget_track(const std::string& track) {
  return guarded(
      [&] { return outcome(impl_->forget_track.call({track}, impl_->options.timeout)); });
}

Result<ServerStatus> Client::status() {
  return guarded([&]() -> Result<ServerStatus> {
    const auto response = impl_->get_status.call({}, impl_->options.timeout);
    if (Status status = outcome(response); !status.ok()) return status;
    return sdk::to_server_status(*response);
  });
}

Status Client::load_model(const std::string& source, const std::string& name) {
  return guarded([&] {
    return outcome(impl_->load_model.call({source, name}, impl_->options.detect_timeout));
  });
}

Status Client::unload_model(const std::string& name) {
  return guarded(
      [&] { return outcome(impl_->unload_model.call({name}, impl_->options.detect_timeout)); });
}

Result<Recording> Client::Impl::call_record(const msgs::Record_Request& request) const {
  const auto reply = record.call(request, options.timeout);
  if (reply.status().code == StatusCode::unavailable) {
    return Status(StatusCode::unavailable,
                  "the server records nothing: it has no camera of its own (capture.source)");
  }
  if (Status status = outcome(reply); !status.ok()) return status;
  return Recording{reply->path, static_cast<int>(reply->frames), reply->bytes};
}

Result<Recording> Client::start_recording(const std::string& path, double seconds) {
  return guarded([&] { return impl_->call_record({path, seconds, false}); });
}

Result<Recording> Client::stop_recording() {
  return guarded([&] { return impl_->call_record({"", 0, true}); });
}

}  // namespace bpa
