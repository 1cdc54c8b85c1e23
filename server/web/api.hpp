// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "idl/wire/msg/diagnostic_msgs.hpp"
#include "server/services/parameter_setter.hpp"
#include "server/services/requests.hpp"
#include "server/web/feed.hpp"
#include "server/web/http.hpp"
#include "server/web/look_alikes.hpp"
#include "server/web/polls.hpp"
#include "server/web/recent_log.hpp"

namespace bpa::server::web {

/// What the page shows and does, of the server; all of it outlives the page.
struct PageLinks {
  ServiceContext context;
  std::shared_ptr<ParameterSetter> setter;
  std::function<wire::bpa_msgs::GetStatus_Response()> status;
  std::function<wire::diagnostic_msgs::DiagnosticArray()> diagnostics;
  /// Of the server's own camera.
  std::function<void(const wire::bpa_msgs::Record_Request&, const Answer<wire::bpa_msgs::Record>&)>
      record;
  std::function<std::int64_t()> now_ns;  ///< As frames' stamps have it.
};

/// What each path answers. Requests do what those of the DDS services do, by the same functions.
class Api {
 public:
  Api(PageLinks links, Feed& feed, const RecentLog& log);

  /// Makes a call in its client's turn, on another thread.
  using TakeTurn = std::function<void(const Address& client, std::function<void()> call,
                                      const Responder& respond)>;
  /// What serves the request. The page's own files need no token: they are no secret. Fails with
  /// not_found where there is no such method and path. `take_turn` outlives the route.
  Result<Route> route(const RequestHead& head, const TakeTurn& take_turn);

 private:
  struct Call {
    const Request& request;
    const std::vector<std::string>& parts;  ///< Of the path, that its pattern leaves open.
    const Responder& respond;
  };
  struct Endpoint {
    const char* method;
    const char* pattern;  ///< "*" stands for one part.
    std::uint64_t max_body;
    void (Api::*handle)(const Call&);
  };
  static const Endpoint kEndpoints[];
  static const Endpoint* find(const RequestHead& head, std::vector<std::string>& parts);
  void poll(const Request& request, Responder respond);

  std::string news(const Poll& poll) const;
  void frame_picture(const Call& call);
  void result(const Call& call);
  void result_picture(const Call& call);
  void cloud(const Call& call);
  void archive(const Call& call);
  void outlines(const Call& call);
  void score_terms(const Call& call);
  void models(const Call& call);
  void thumbnail(const Call& call);
  void surface(const Call& call);
  void load(const Call& call);
  void unload(const Call& call);
  void look_alikes(const Call& call);
  void health(const Call& call);
  void parameters(const Call& call);
  void set_parameter(const Call& call);
  void search(const Call& call);
  void upload(const Call& call);
  void record(const Call& call);

  std::shared_ptr<const KeptResult> kept(const Call& call) const;
  static const Interpretation* interpretation(const Call& call, const KeptResult& result);
  std::shared_ptr<const ObjectModel> model(const Call& call) const;
  Asker asker(const Request& request) const;
  void submit_search(const Call& call, Result<DetectJob> job, const std::string& origin);

  const PageLinks links_;
  Feed& feed_;
  const RecentLog& log_;
  LookAlikes look_alikes_;
  Polls polls_;  ///< Last: its thread uses what stands above.
};

}  // namespace bpa::server::web
