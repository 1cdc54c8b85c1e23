// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "server/web/api.hpp"

#include <algorithm>
#include <charconv>
#include <utility>

#include "core/base/concat.hpp"
#include "core/base/guarded.hpp"
#include "core/doctor/frame_check.hpp"
#include "core/doctor/result_check.hpp"
#include "core/draw/sheet.hpp"
#include "core/io/image_file.hpp"
#include "core/io/model_file.hpp"
#include "idl/wire/status.hpp"
#include "server/web/assets.hpp"
#include "server/web/json_text.hpp"
#include "server/web/outlines.hpp"
#include "server/web/search_request.hpp"
#include "server/web/to_json.hpp"

namespace bpa::server::web {
namespace {

namespace msgs = wire::bpa_msgs;
using Json = nlohmann::json;

constexpr std::uint64_t kMaxSmallBody = 65536;  ///< Of a request in JSON: 10 000 corners drawn.
/// A PCD file of 1280 x 720 points in binary has 18 MB, two PNG images of 1920 x 1080 have 8 MB.
constexpr std::uint64_t kMaxUploadBytes = std::uint64_t{64} << 20U;
constexpr int kThumbnailSide = 200;  ///< Pixels.

std::uint64_t number_of(const std::string& text) {
  std::uint64_t number = 0;
  std::from_chars(text.data(), text.data() + text.size(), number);
  return number;
}

std::vector<std::string> split(const std::string& path) {
  std::vector<std::string> parts;
  for (std::size_t at = 0; at < path.size();) {
    const std::size_t end = std::min(path.find('/', at + 1), path.size());
    parts.push_back(path.substr(at + 1, end - at - 1));
    at = end;
  }
  return parts;
}

const Asset* find_asset(const std::string& path) {
  const auto found = std::ranges::find(assets(), path, &Asset::path);
  return found == assets().end() ? nullptr : &*found;
}

void respond_with(const Responder& respond, const Result<Bytes>& bytes, const char* type) {
  respond(bytes.ok() ? bytes_response(*bytes, type) : refusal(bytes.status()));
}

/// The picture that the path's last part names.
void respond_with_picture(const Request& request, const Responder& respond, ShownFrame& shown) {
  const bool color = request.path.ends_with("/color");
  respond_with(respond, color ? shown.color() : shown.depth(), "image/jpeg");
}

/// The response of a service in HTTP.
web::Response response_to(bool success, const wire::bpa_msgs::Status& status, Json more) {
  if (!success) return refusal(wire::to_status(status));
  more["ok"] = true;
  return json_response(json_text(more));
}

/// For both changes of the library.
auto answer_of_change(const Responder& respond) {
  return [respond](const auto& response) {
    respond(
        response_to(response.success, response.status, {{"version", response.database_version}}));
  };
}

}  // namespace

const Api::Endpoint Api::kEndpoints[] = {
    {"GET", "/api/frames/*/color", 0, &Api::frame_picture},
    {"GET", "/api/frames/*/depth", 0, &Api::frame_picture},
    {"GET", "/api/results/*", 0, &Api::result},
    {"GET", "/api/results/*/color", 0, &Api::result_picture},
    {"GET", "/api/results/*/depth", 0, &Api::result_picture},
    {"GET", "/api/results/*/cloud", 0, &Api::cloud},
    {"GET", "/api/results/*/archive", 0, &Api::archive},
    {"GET", "/api/results/*/outlines", 0, &Api::outlines},
    {"GET", "/api/results/*/score", 0, &Api::score_terms},
    {"GET", "/api/models", 0, &Api::models},
    {"GET", "/api/models/*/thumbnail", 0, &Api::thumbnail},
    {"GET", "/api/models/*/surface", 0, &Api::surface},
    {"GET", "/api/look_alikes", 0, &Api::look_alikes},
    {"GET", "/api/health", 0, &Api::health},
    {"GET", "/api/parameters", 0, &Api::parameters},
    {"POST", "/api/parameters", kMaxSmallBody, &Api::set_parameter},
    {"POST", "/api/models/*/load", kMaxSmallBody, &Api::load},
    {"POST", "/api/models/*/unload", kMaxSmallBody, &Api::unload},
    {"POST", "/api/search", kMaxSmallBody, &Api::search},
    {"POST", "/api/upload", kMaxUploadBytes, &Api::upload},
    {"POST", "/api/record", kMaxSmallBody, &Api::record},
};

Api::Api(PageLinks links, Feed& feed, const RecentLog& log)
    : links_(std::move(links)),
      feed_(feed),
      log_(log),
      look_alikes_(links_.context.recognition),
      polls_(
          feed, [this] { return links_.context.settings.get()->web.rate_hz; },
          [this](const Poll& poll) { return news(poll); }) {}

const Api::Endpoint* Api::find(const RequestHead& head, std::vector<std::string>& parts) {
  const std::vector<std::string> path = split(head.path);
  for (const Endpoint& endpoint : kEndpoints) {
    const std::vector<std::string> pattern = split(endpoint.pattern);
    if (head.method != endpoint.method || path.size() != pattern.size()) continue;
    parts.clear();
    bool same = true;
    for (std::size_t i = 0; i < path.size() && same; ++i) {
      if (pattern[i] == "*") {
        parts.push_back(path[i]);
      } else {
        same = path[i] == pattern[i];
      }
    }
    if (same) return &endpoint;
  }
  return nullptr;
}

Result<Route> Api::route(const RequestHead& head, const TakeTurn& take_turn) {
  if (const Asset* asset = head.method == "GET" ? find_asset(head.path) : nullptr) {
    return Route{
        .right = Right::everyone, .serve = [asset](Request&&, const Responder& respond) {
          respond({.type = std::string(asset->type), .fixed = asset->zipped, .zipped = true});
        }};
  }
  if (head.method == "GET" && head.path == "/api/live") {  // waits for news, and needs no turn
    return Route{.serve = [this](Request&& request, Responder respond) {
      poll(request, std::move(respond));
    }};
  }
  std::vector<std::string> parts;
  const Endpoint* endpoint = find(head, parts);
  if (endpoint == nullptr) return not_found("there is nothing to ", head.method, " at this path");
  return Route{.max_body = endpoint->max_body,
               .serve = [this, endpoint, parts = std::move(parts), &take_turn](Request&& request,
                                                                               Responder respond) {
                 const auto shared = std::make_shared<const Request>(std::move(request));
                 take_turn(
                     shared->address,
                     [=, this] {
                       (this->*endpoint->handle)({*shared, parts, respond});
                     },
                     respond);
               }};
}

void Api::poll(const Request& request, Responder respond) {
  const bool tracks = request.value("tracks") == "1";
  const Status seen = feed_.see(request.value("viewer"), tracks, number_of(request.value("held")));
  if (!seen.ok()) return respond(refusal(seen));
  polls_.add({request.value("viewer"), number_of(request.value("sequence")),
              number_of(request.value("result")), tracks, std::move(respond)});
}

/// What happened since the viewer asked last. Of several new results the last has everything.
std::string Api::news(const Poll& poll) const {
  const std::uint64_t sequence = feed_.sequence();
  std::string text = concat("{\"sequence\":", sequence, ",\"now_ns\":", links_.now_ns(),
                            ",\"status\":", status_json(links_.status()));
  if (const auto frame = feed_.camera_frame()) {
    text += ",\"frame\":" + json_text({{"id", frame->id},
                                       {"stamp_ns", frame->stamp_ns},
                                       {"came_ns", frame->came_ns},
                                       {"frame_id", frame->frame_id}});
  }
  const auto results = feed_.tell(poll.viewer, poll.result);
  text += ",\"results\":[";
  for (const auto& result : results) {
    text += (result == results.front() ? "" : ",") + result->summary();
  }
  text += "]";
  if (!results.empty()) text += ",\"newest\":" + results.back()->json();
  if (const std::string tracks = poll.tracks ? feed_.tracks() : ""; !tracks.empty()) {
    text += ",\"tracks\":" + tracks;
  }
  return text + "}";
}

void Api::frame_picture(const Call& call) {
  const auto frame = feed_.camera_frame(number_of(call.parts[0]));
  if (!frame) return call.respond(refusal(not_found("this frame is no longer kept")));
  respond_with_picture(call.request, call.respond, *frame->shown);
}

/// The result that a path names; otherwise the call is answered, and this is null.
std::shared_ptr<const KeptResult> Api::kept(const Call& call) const {
  auto result = feed_.result(number_of(call.parts[0]));
  if (!result) {
    call.respond(refusal(not_found("result ", call.parts[0].substr(0, 20),
                                   " is no longer kept; web.history says how many are")));
  }
  return result;
}

void Api::result(const Call& call) {
  if (const auto result = kept(call)) call.respond(json_response(result->json()));
}

void Api::result_picture(const Call& call) {
  if (const auto result = kept(call)) {
    respond_with_picture(call.request, call.respond, *result->shown);
  }
}

void Api::cloud(const Call& call) {
  const auto result = kept(call);
  if (result) respond_with(call.respond, result->shown->cloud(), "application/octet-stream");
}

void Api::archive(const Call& call) {
  const auto result = kept(call);
  if (!result) return;
  const auto bytes = result->shown->archive(io::results_json({result->result}));
  if (!bytes.ok()) return call.respond(refusal(bytes.status()));
  web::Response response = bytes_response(*bytes, "application/x-tar");
  response.file_name = concat("frame_", result->result.stamp_ns, ".tar");
  call.respond(std::move(response));
}

/// The interpretation whose rank a query has, the best without; otherwise the call is answered, and
/// this is null.
const Interpretation* Api::interpretation(const Call& call, const KeptResult& result) {
  const std::uint64_t rank = std::max<std::uint64_t>(1, number_of(call.request.value("rank")));
  const auto& found = result.result.interpretations;
  if (rank <= found.size()) return &found[rank - 1];
  call.respond(
      refusal(not_found("rank is ", rank, "; the result has ", found.size(), " interpretations")));
  return nullptr;
}

void Api::outlines(const Call& call) {
  const auto result = kept(call);
  if (!result) return;
  const Interpretation* one = interpretation(call, *result);
  if (one == nullptr) return;
  call.respond(
      json_response(outlines_json(*one, result->camera, links_.context.recognition->models())));
}

void Api::score_terms(const Call& call) {
  const auto result = kept(call);
  if (!result) return;
  const Interpretation* one = interpretation(call, *result);
  if (one == nullptr) return;
  const std::uint64_t number = number_of(call.request.value("placement"));
  if (number >= one->placements.size()) {
    return call.respond(refusal(not_found("placement is ", number, "; the interpretation has ",
                                          one->placements.size(), " placements, from 0")));
  }
  call.respond(json_response(
      score_terms_json(links_.context.recognition->score_terms(one->placements[number]))));
}

void Api::models(const Call& call) {
  const Recognition& recognition = *links_.context.recognition;
  const std::string& folder = links_.context.settings.get()->detection.library;
  call.respond(json_response(models_json(recognition, io::list_models(folder))));
}

/// The model that a path names; otherwise the call is answered, and this is null.
std::shared_ptr<const ObjectModel> Api::model(const Call& call) const {
  for (const auto& model : links_.context.recognition->models()) {
    if (model->name == call.parts[0]) return model;
  }
  call.respond(refusal(not_found("no model of that name is loaded")));
  return nullptr;
}

void Api::thumbnail(const Call& call) {
  const auto model = this->model(call);
  if (!model) return;
  const auto png = io::encode_color_png(draw::model_thumbnail(*model, kThumbnailSide));
  if (!png.ok()) return call.respond(refusal(png.status()));
  call.respond(bytes_response(std::make_shared<const std::string>(*png), "image/png"));
}

void Api::surface(const Call& call) {
  const auto model = this->model(call);
  if (!model) return;
  call.respond(bytes_response(std::make_shared<const std::string>(surface_bytes(*model)),
                              "application/octet-stream"));
}

/// Clients that share an address share their turns.
Asker Api::asker(const Request& request) const {
  return {request.address, hook_of_peer(links_.context.log, "the page")};
}

void Api::load(const Call& call) {
  msgs::LoadModel_Request request;
  request.source = call.parts[0];
  load_model(links_.context, asker(call.request), request, answer_of_change(call.respond));
}

void Api::unload(const Call& call) {
  msgs::UnloadModel_Request request;
  request.name = call.parts[0];
  unload_model(links_.context, asker(call.request), request, answer_of_change(call.respond));
}

void Api::look_alikes(const Call& call) {
  const LookAlikes::Answer answer = look_alikes_.ask();
  if (!answer.status.ok()) return call.respond(refusal(answer.status));
  call.respond(json_response(findings_json(answer.findings, answer.running)));
}

void Api::health(const Call& call) {
  const std::uint64_t last = number_of(call.request.value("log"));
  call.respond(json_response(concat("{\"status\":", status_json(links_.status()),
                                    ",\"diagnostics\":", diagnostics_json(links_.diagnostics()),
                                    ",\"log\":", log_json(log_.after(last)), "}")));
}

void Api::parameters(const Call& call) {
  call.respond(json_response(parameters_json(*links_.context.settings.get())));
}

void Api::set_parameter(const Call& call) {
  const auto parameter = parameter_from_json(call.request.body);
  if (!parameter.ok()) return call.respond(refusal(parameter.status()));
  const auto result = links_.setter->set({*parameter}, asker(call.request).log);
  if (!result.successful) return call.respond(refusal(invalid_argument(result.reason)));
  call.respond(json_response("{\"ok\":true}"));
}

void Api::submit_search(const Call& call, Result<DetectJob> job, const std::string& origin) {
  if (job.ok()) {
    job->client = call.request.address;
    job->done = [this, origin, respond = call.respond](const DetectJob&, const Frame* frame,
                                                       const Result<SceneInterpretations>& result) {
      if (!result.ok()) return respond(refusal(result.status()));
      const double range = links_.context.settings.get()->detector.surface.max_range_m;
      const std::string advice = doctor::advice_on(*frame, *result, range);
      const std::uint64_t id = feed_.add_asked(*frame, *result, origin, advice);
      respond(json_response(concat("{\"ok\":true,\"result\":", id, "}")));
    };
  }
  const Status accepted = submit(links_.context, std::move(job));
  if (!accepted.ok()) call.respond(refusal(accepted));
}

void Api::search(const Call& call) {
  std::shared_ptr<const Frame> frame;
  const std::string of = call.request.value("result");
  if (!of.empty()) {
    const auto result = feed_.result(number_of(of));
    if (!result) return call.respond(refusal(not_found("result ", of, " is no longer kept")));
    frame = result->shown->frame();
  }
  submit_search(call,
                search_job(call.request.body, frame, links_.context.settings.get()->detection),
                frame ? "region" : "next frame");
}

void Api::upload(const Call& call) {
  Result<Frame> frame =
      uploaded_frame(call.request, links_.context.settings.get()->detector.surface.max_range_m);
  if (!frame.ok()) return call.respond(refusal(frame.status()));
  frame->stamp_ns = links_.now_ns();
  submit_search(call,
                search_job("", std::make_shared<const Frame>(std::move(frame).value()),
                           links_.context.settings.get()->detection),
                "upload");
}

void Api::record(const Call& call) {
  const Json json = Json::parse(call.request.body, nullptr, false);
  msgs::Record_Request request;
  try {
    request.stop = json.value("stop", false);
    request.path = json.value("path", "");
    request.seconds = json.value("seconds", 0.0);
  } catch (const Json::exception&) {
    return call.respond(refusal(invalid_argument(
        "the body must be JSON like {\"path\": \"a.oni\", \"seconds\": 10} or {\"stop\": true}")));
  }
  links_.record(request, [respond = call.respond](const msgs::Record_Response& response) {
    respond(response_to(
        response.success, response.status,
        {{"path", response.path}, {"frames", response.frames}, {"bytes", response.bytes}}));
  });
}

}  // namespace bpa::server::web
