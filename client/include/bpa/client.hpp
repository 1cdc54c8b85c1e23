// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <bpa/status.hpp>
#include <bpa/types.hpp>

// Talk to a running bpa-server, from any process and any host. C++17; no DDS, PCL or OpenCV type
// appears here.
//
//   auto client = bpa::Client::connect();
//   if (!client.ok()) return fail(client.status().message);
//   auto found = client->detect({{"mug"}});
//   if (!found.ok()) return fail(found.status().message);
//   for (const auto& d : found->best()) std::cout << d.model << ' ' << d.probability << '\n';

namespace bpa {

/// How far discovery reaches; the meaning of ROS_AUTOMATIC_DISCOVERY_RANGE.
enum class DiscoveryRange { subnet, localhost, off };

struct ClientOptions {
  /// DDS domain, 0 to 232; -1 takes ROS_DOMAIN_ID, and 0 without it.
  int domain = -1;
  /// The server's ROS 2 namespace.
  std::string server_namespace = "/bpa";
  /// The longest that connect() and any call but the following wait.
  std::chrono::milliseconds timeout{5000};
  /// The longest that a detect or load_model call waits which names no time of its own.
  std::chrono::milliseconds detect_timeout{60000};
  /// Where connect() and the calls look for servers; the environment (ROS_LOCALHOST_ONLY,
  /// ROS_AUTOMATIC_DISCOVERY_RANGE, ROS_STATIC_PEERS) decides where this is not set.
  bool range_from_environment = true;
  DiscoveryRange range = DiscoveryRange::subnet;
  std::vector<std::string> peers;  ///< More host names or addresses to look at.
  /// DDS Security, as the server has it: the folder that bpa-server --make-keystore or SROS 2 made,
  /// and whose keys of it are ours. Empty: as ROS_SECURITY_ENABLE and its like say. Needs Fast
  /// DDS 3.
  std::string keystore;
  std::string enclave = "/robot";
  /// Receives what the SDK has to say (such as a type or QoS that does not match), from any thread.
  std::function<void(const std::string&)> log;
};

/// One connection. Every call may be made from any thread and ends within its time-out. A server
/// that restarts is found again by itself: calls made meanwhile fail with `unavailable`, and
/// subscriptions go on. After a move the source may only be destroyed or assigned to.
class Client {
 public:
  /// Joins the domain and waits for a server. Fails with `unavailable` when none answers in time,
  /// with `invalid_argument` on an option that breaks its rule. An enclave that may not call
  /// get_status, such as /viewer, waits for nothing: its calls fail with `unsupported`, its
  /// subscriptions work.
  static Result<Client> connect(const ClientOptions& options = {});

  /// The models that the server looks for, by number.
  Result<std::vector<KnownModel>> models();

  /// Searches the next frame that the server's camera sees. `timeout` 0 means detect_timeout.
  /// Fails with `busy` when the server's queue is full, `timeout`, `unavailable`, `not_found` (a
  /// model name), `invalid_argument` (naming the field and the rule).
  Result<DetectionSet> detect(const DetectQuery& query = {},
                              std::chrono::milliseconds timeout = {});
  /// Searches a frame of your own instead.
  Result<DetectionSet> detect_in(const FrameView& frame, const DetectQuery& query = {},
                                 std::chrono::milliseconds timeout = {});

  /// Searches 1 to 16 frames of one scene as one: the evidence of all views counts. `fixed_frame`
  /// names the frame of the poses and of the result. Priors of `query` are in the first frame's
  /// camera.
  Result<SceneDetections> detect_views(const std::vector<PosedFrame>& views,
                                       const std::string& fixed_frame,
                                       const DetectQuery& query = {},
                                       std::chrono::milliseconds timeout = {});

  /// Hands a frame to the server's stream; subscribers get the result. When frames come
  /// faster than they are searched, the server takes the newest. Returns once the frame is sent,
  /// not when it is searched. Fails with `unavailable` when no server listens within the time-out.
  /// `priors`: what is known of the objects' poses before the search.
  Status publish_frame(const FrameView& frame, const std::vector<ExpectedPose>& priors = {});

  /// Calls `on_result` for every frame that the server searched, on one thread of the SDK, until
  /// the client is destroyed. `on_result` must not destroy the client. DetectionSet::status tells
  /// why a search failed. A second call replaces the first one's function.
  Status subscribe(std::function<void(const DetectionSet&)> on_result);
  /// The same for the frames that clients publish to the server's stream, as they were sent; the
  /// pixels are there while the function runs. A ROS 2 camera's images are not among them.
  Status subscribe_frames(std::function<void(const FrameView&)> on_frame);
  /// The same for the annotated images, which the server draws only for subscribers.
  Status subscribe_annotated(std::function<void(const AnnotatedImage&)> on_image);

  /// The same for the tracks: objects that the server follows from frame to frame at the camera's
  /// rate. It follows them while there is a subscriber.
  Status tracks(std::function<void(const TrackSet&)> on_tracks);
  /// Edit a track, named by its name or its id in decimal digits. Fail with `not_found` without
  /// one, which lists the tracks there are.
  /// A name has 1 to 100 letters, digits, '_', '-' and '.', not digits alone; `invalid_argument` on
  /// others, and on one that another track or frame of /tf has.
  Status rename_track(const std::string& track, const std::string& name);
  /// Keeps a track however long its object is not seen; false: no longer.
  Status hold_track(const std::string& track, bool hold = true);
  /// Ends a track.
  Status forget_track(const std::string& track);

  Result<ServerStatus> status();

  /// Adds a model of the server's library directory by name, or one below the server's
  /// detection.model_folder by path. `name`: letters, digits, '_', '-' and '.'; empty: its own.
  Status load_model(const std::string& source, const std::string& name = "");
  /// Stops looking for a model.
  Status unload_model(const std::string& name);

  /// Has the server record its own camera (not that of a ROS 2 driver). `path`: a new .oni file
  /// below the server's capture.record_folder, absolute or from there. It ends after `seconds` (at
  /// most 3600), at the server's quota or with stop_recording(). Fails with `unavailable` when the
  /// server has no camera or the quota is used up, `unsupported` without such a folder, `busy`
  /// while it records, `invalid_argument` on an unsuitable path.
  Result<Recording> start_recording(const std::string& path, double seconds = 60);
  /// Completes the file; also tells about a recording that ended by itself, or why it failed.
  /// `not_found` without one.
  Result<Recording> stop_recording();

  Client(Client&&) noexcept;
  Client& operator=(Client&&) noexcept;
  Client(const Client&) = delete;
  Client& operator=(const Client&) = delete;
  ~Client();

 private:
  struct Impl;
  explicit Client(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace bpa
