// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <chrono>
#include <memory>
#include <utility>

#include "core/base/concat.hpp"
#include "core/base/guarded.hpp"
#include "ros/frames.hpp"
#include "server/convert/results.hpp"
#include "server/services/requests.hpp"
#include "server/services/services.hpp"

namespace bpa::server {
namespace {

namespace msgs = wire::bpa_msgs;

constexpr std::uint32_t kMaxTopK = 100;
constexpr int kMaxBudgetMs = 1'000'000;
constexpr int kMaxTimeoutMs = 10'000'000;
/// A frame of the largest sides has 604 MB: rgba, depth in metres and a mask.
constexpr std::size_t kMaxFrameRequest = std::size_t{640} << 20U;

/// As search_of(), with its priors; checks the time-out, too.
Result<DetectRequest> whole_search_of(const msgs::Detect_Request& request,
                                      const DetectionOptions& options) {
  Result<DetectRequest> search = search_of(request, options);
  if (!search.ok()) return search;
  if (!(request.timeout_ms >= 0 && request.timeout_ms <= kMaxTimeoutMs)) {
    return invalid_argument("timeout_ms is ", request.timeout_ms, "; it must be between 0 and ",
                            kMaxTimeoutMs);
  }
  auto priors = ros::priors_from_messages(request.frame.priors);
  if (!priors.ok()) return priors.status();
  search->priors = std::move(priors).value();
  return search;
}

/// Makes the job of a request whose fields are legal.
DetectJob job_of(std::shared_ptr<msgs::Detect_Request> request, const DetectRequest& search,
                 const DetectionOptions& options) {
  DetectJob job;
  job.request = search;
  const double timeout_ms =
      request->timeout_ms > 0 ? request->timeout_ms : options.request_timeout_ms;
  job.timeout = std::chrono::duration_cast<std::chrono::nanoseconds>(
      std::chrono::duration<double, std::milli>(timeout_ms));
  if (request->has_frame) {
    job.decode = [request] { return ros::frame_from_message(std::move(request->frame)); };
  } else if (request->frame.roi.width > 0 || !request->frame.mask.empty() ||
             !request->frame.priors.empty()) {
    job.restrict_frame = [request](Frame& frame) {
      return ros::restrict_frame(request->frame, frame);
    };
  }
  return job;
}

/// `refusal` is what the response is without a frame.
msgs::Detect_Response answer_of(const ServiceContext& context, const DetectJob& job,
                                const Frame* frame, const Result<SceneInterpretations>& result,
                                msgs::Detect_Response refusal) {
  msgs::Detect_Response response = std::move(refusal);
  response.success = result.ok();
  response.queue_position = static_cast<std::uint32_t>(job.position);
  if (frame == nullptr) return response;
  const auto& named = job.request.models;
  const auto models = named.empty() ? context.recognition->models().size() : named.size();
  const double range = context.settings.get()->detector.surface.max_range_m;
  response.result = interpretations_message(
      result, {frame->stamp_ns, frame->frame_id, static_cast<int>(models), job.request.seed,
               result.ok() ? context.advice.on(*frame, *result, range) : ""});
  return response;
}

/// A change of the library: `change(request, response)`, when its turn comes.
template <class Service, class Change>
void change_library(const ServiceContext& context, const Asker& asker, const char* name,
                    Change change, typename Service::Request request,
                    const Answer<Service>& answer) {
  const auto finish = [context, hook = asker.log, name, answer](
                          const Status& status, typename Service::Response& response) {
    response.success = status.ok();
    response.status = to_message(status);
    response.database_version = context.recognition->version();
    log(hook, LogLevel::info,
        std::string(name) + (status.ok() ? ": done" : " failed: " + status.message));
    if (status.ok()) context.library_changed();
    answer(response);
  };
  const auto work = [finish, change, request = std::move(request)] {
    typename Service::Response response;
    const Status status =
        guarded("the library cannot be changed", [&] { return change(request, response); });
    finish(status, response);
  };
  const auto refuse = [finish](const Status& status) {
    typename Service::Response response;
    finish(status, response);
  };
  context.queue.run_later(asker.client, {work, refuse});
}

/// A service that changes the library.
template <class Service, class Change>
void add_change(const ServiceContext& context, const char* name, Change change,
                ServiceSet& services) {
  services.add<Service>(
      name, [context, change](typename Service::Request&& request, const Reply<Service>& reply) {
        change(context, reply.asker(), std::move(request),
               [reply](const typename Service::Response& response) { reply.send(response); });
      });
}

}  // namespace

Status check_search(std::uint32_t top_k, double time_budget_ms) {
  if (top_k > kMaxTopK) {
    return invalid_argument("top_k is ", top_k, "; it must be between 1 and ", kMaxTopK,
                            ", or 0 for the server's setting");
  }
  if (!(time_budget_ms >= 0 && time_budget_ms <= kMaxBudgetMs)) {
    return invalid_argument("time_budget_ms is ", time_budget_ms, "; it must be between 0 and ",
                            kMaxBudgetMs);
  }
  return {};
}

Result<DetectJob> detect_job(msgs::Detect_Request&& request, const DetectionOptions& options) {
  const auto shared = std::make_shared<msgs::Detect_Request>(std::move(request));
  const Result<DetectRequest> search = whole_search_of(*shared, options);
  if (!search.ok()) return search.status();
  return job_of(shared, *search, options);
}

Status submit(const ServiceContext& context, Result<DetectJob> job) {
  Status status = job.ok() ? context.queue.push(std::move(job).value()) : job.status();
  if (!status.ok()) context.statistics.add(&Counts::requests_refused);
  return status;
}

msgs::ListModels_Response list_models(const Recognition& recognition,
                                      const std::vector<std::string>& names) {
  msgs::ListModels_Response response;
  response.library = recognition.library();
  response.database_version = recognition.version();
  const Models models = recognition.models();
  const auto broken = recognition.broken();
  for (const std::string& name : names) {
    const auto has_name = [&](const auto& model) { return model->name == name; };
    if (std::ranges::any_of(models, has_name)) continue;
    const auto damaged = std::ranges::find(broken, name, &io::BrokenModel::name);
    response.status =
        to_message(damaged != broken.end()
                       ? damaged->reason
                       : Status(StatusCode::not_found, "there is no model named \"" + name + "\""));
    return response;
  }
  for (const auto& model : models) {
    const bool named = std::ranges::find(names, model->name) != names.end();
    if (named || names.empty()) response.models.push_back(model_message(*model));
  }
  response.success = true;
  if (names.empty()) response.status = to_message(io::explain_broken(response.library, broken));
  return response;
}

void load_model(const ServiceContext& context, const Asker& asker, msgs::LoadModel_Request request,
                const Answer<msgs::LoadModel>& answer) {
  const auto load = [recognition = context.recognition](const msgs::LoadModel_Request& wanted,
                                                        msgs::LoadModel_Response& response) {
    const auto model = recognition->load(wanted.source, wanted.name);
    if (model.ok()) response.model = model_message(**model);
    return model.status();
  };
  change_library<msgs::LoadModel>(context, asker, "load_model", load, std::move(request), answer);
}

void unload_model(const ServiceContext& context, const Asker& asker,
                  msgs::UnloadModel_Request request, const Answer<msgs::UnloadModel>& answer) {
  const auto unload = [recognition = context.recognition](const msgs::UnloadModel_Request& wanted,
                                                          msgs::UnloadModel_Response&) {
    return recognition->unload(wanted.name);
  };
  change_library<msgs::UnloadModel>(context, asker, "unload_model", unload, std::move(request),
                                    answer);
}

void add_detect(const ServiceContext& context, ServiceSet& services) {
  services.add<msgs::Detect>(
      "detect",
      [context](msgs::Detect_Request&& request, const Reply<msgs::Detect>& reply) {
        Result<DetectJob> job = detect_job(std::move(request), context.settings.get()->detection);
        if (job.ok()) {
          job->client = reply.client();
          job->done = [context, reply](const DetectJob& done, const Frame* frame,
                                       const Result<SceneInterpretations>& result) {
            const Status& status = result.status();
            if (!status.ok()) log(reply.log(), LogLevel::info, "detect failed: " + status.message);
            reply.guard([&] {
              reply.send(answer_of(context, done, frame, result, reply.refusal(status)));
            });
          };
        }
        const Status accepted = submit(context, std::move(job));
        if (!accepted.ok()) reply.refuse(accepted);
      },
      kMaxFrameRequest);
}

void add_library_services(const ServiceContext& context, ServiceSet& services) {
  services.add_quick<msgs::ListModels>(
      "list_models", [recognition = context.recognition](const msgs::ListModels_Request& request) {
        return list_models(*recognition, request.names);
      });
  add_change<msgs::LoadModel>(context, "load_model", load_model, services);
  add_change<msgs::UnloadModel>(context, "unload_model", unload_model, services);
}

}  // namespace bpa::server
