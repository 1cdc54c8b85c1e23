// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tuple>

#include "idl/wire/messages.hpp"

namespace bpa::wire {

using AllTypes = std::tuple<
    bpa_msgs::Status, bpa_msgs::Bingham, bpa_msgs::PosePrior, bpa_msgs::RgbdFrame,
    bpa_msgs::ScoreComponent, bpa_msgs::PoseAlternative, bpa_msgs::Placement,
    bpa_msgs::Interpretation, bpa_msgs::StageTiming, bpa_msgs::SceneInterpretations,
    bpa_msgs::ContinuousSymmetry, bpa_msgs::MissedModel, bpa_msgs::ModelInfo,
    bpa_msgs::Detect_Request, bpa_msgs::Detect_Response, bpa_msgs::ListModels_Request,
    bpa_msgs::ListModels_Response, bpa_msgs::LoadModel_Request, bpa_msgs::LoadModel_Response,
    bpa_msgs::UnloadModel_Request, bpa_msgs::UnloadModel_Response, bpa_msgs::Record_Request,
    bpa_msgs::Record_Response, bpa_msgs::GetStatus_Request, bpa_msgs::GetStatus_Response,
    bpa_msgs::Track, bpa_msgs::Tracks, bpa_msgs::EndedTrack, bpa_msgs::RenameTrack_Request,
    bpa_msgs::RenameTrack_Response, bpa_msgs::HoldTrack_Request, bpa_msgs::HoldTrack_Response,
    bpa_msgs::ForgetTrack_Request, bpa_msgs::ForgetTrack_Response, bpa_msgs::GroupModel,
    bpa_msgs::GroupLibrary, bpa_msgs::GroupWorker, bpa_msgs::GroupFront, bpa_msgs::GroupPrior,
    bpa_msgs::GroupCandidate, bpa_msgs::GroupTask, bpa_msgs::GroupAnswer,
    bpa_msgs::GetModelFile_Request, bpa_msgs::GetModelFile_Response, bpa_msgs::DetectViews_Request,
    bpa_msgs::DetectViews_Response, builtin_interfaces::Time, builtin_interfaces::Duration,
    diagnostic_msgs::KeyValue, diagnostic_msgs::DiagnosticStatus, diagnostic_msgs::DiagnosticArray,
    geometry_msgs::Point, geometry_msgs::Vector3, geometry_msgs::Quaternion, geometry_msgs::Pose,
    geometry_msgs::PoseStamped, geometry_msgs::PoseWithCovariance, geometry_msgs::Transform,
    geometry_msgs::TransformStamped, geometry_msgs::Twist, rcl_interfaces::Log,
    rcl_interfaces::ParameterValue, rcl_interfaces::Parameter, rcl_interfaces::FloatingPointRange,
    rcl_interfaces::IntegerRange, rcl_interfaces::ParameterDescriptor,
    rcl_interfaces::ParameterType, rcl_interfaces::SetParametersResult,
    rcl_interfaces::ListParametersResult, rcl_interfaces::ParameterEvent,
    rcl_interfaces::ListParameters_Request, rcl_interfaces::ListParameters_Response,
    rcl_interfaces::GetParameters_Request, rcl_interfaces::GetParameters_Response,
    rcl_interfaces::SetParameters_Request, rcl_interfaces::SetParameters_Response,
    rcl_interfaces::SetParametersAtomically_Request,
    rcl_interfaces::SetParametersAtomically_Response, rcl_interfaces::DescribeParameters_Request,
    rcl_interfaces::DescribeParameters_Response, rcl_interfaces::GetParameterTypes_Request,
    rcl_interfaces::GetParameterTypes_Response, rmw_dds_common::Gid,
    rmw_dds_common::NodeEntitiesInfo, rmw_dds_common::ParticipantEntitiesInfo,
    sensor_msgs::RegionOfInterest, sensor_msgs::Image, sensor_msgs::CompressedImage,
    sensor_msgs::CameraInfo, sensor_msgs::PointField, sensor_msgs::PointCloud2, std_msgs::Header,
    std_msgs::ColorRGBA, std_msgs::String, std_srvs::Trigger_Request, std_srvs::Trigger_Response,
    tf2_msgs::TFMessage, vision_msgs::ObjectHypothesis, vision_msgs::ObjectHypothesisWithPose,
    vision_msgs::BoundingBox3D, vision_msgs::Detection3D, vision_msgs::Detection3DArray,
    vision_msgs::VisionInfo, vision_msgs::VisionClass, vision_msgs::LabelInfo,
    visualization_msgs::UVCoordinate, visualization_msgs::MeshFile, visualization_msgs::Marker,
    visualization_msgs::MarkerArray, rosgraph_msgs::Clock, type_description_interfaces::FieldType,
    type_description_interfaces::Field, type_description_interfaces::IndividualTypeDescription,
    type_description_interfaces::TypeDescription, type_description_interfaces::TypeSource,
    type_description_interfaces::KeyValue, type_description_interfaces::GetTypeDescription_Request,
    type_description_interfaces::GetTypeDescription_Response>;

/// Calls visit with the address of an empty message of every type.
template <class Visitor>
void for_each_type(Visitor&& visit) {
  std::apply([&](const auto&... type) { (visit(&type), ...); }, AllTypes{});
}

}  // namespace bpa::wire
