// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <string>

#include <gtest/gtest.h>

#include "idl/wire/messages.hpp"

namespace bpa::wire {
namespace {

template <class T>
void expect_hash(const std::string& hash) {
  EXPECT_EQ(T::kTypeHash, "RIHS01_" + hash) << T::kType;
}

// Read from the files that a ROS 2 Jazzy build installs (share/<package>/msg/<Type>.json).
TEST(TypeHash, StandardTypes) {
  expect_hash<std_msgs::Header>("f49fb3ae2cf070f793645ff749683ac6b06203e41c891e17701b1cb597ce6a01");
  expect_hash<builtin_interfaces::Time>(
      "b106235e25a4c5ed35098aa0a61a3ee9c9b18d197f398b0e4206cea9acf9c197");
  expect_hash<builtin_interfaces::Duration>(
      "e8d009f659816f758b75334ee1a9ca5b5c0b859843261f14c7f937349599d93b");
  expect_hash<sensor_msgs::Image>(
      "d31d41a9a4c4bc8eae9be757b0beed306564f7526c88ea6a4588fb9582527d47");
  expect_hash<sensor_msgs::CompressedImage>(
      "15640771531571185e2efc8a100baf923961a4d15d5569652e6cb6691e8e371a");
  expect_hash<sensor_msgs::CameraInfo>(
      "b3dfd68ff46c9d56c80fd3bd4ed22c7a4ddce8c8348f2f59c299e73118e7e275");
  expect_hash<sensor_msgs::PointCloud2>(
      "9198cabf7da3796ae6fe19c4cb3bdd3525492988c70522628af5daa124bae2b5");
  expect_hash<sensor_msgs::PointField>(
      "5c6a4750728c2bcfbbf7037225b20b02d4429634732146b742dee1726637ef01");
  expect_hash<sensor_msgs::RegionOfInterest>(
      "ad16bcba5f9131dcdba6fbded19f726f5440e3c513b4fb586dd3027eeed8abb1");
  expect_hash<geometry_msgs::Point>(
      "6963084842a9b04494d6b2941d11444708d892da2f4b09843b9c43f42a7f6881");
  expect_hash<geometry_msgs::Quaternion>(
      "8a765f66778c8ff7c8ab94afcc590a2ed5325a1d9a076ffff38fbce36f458684");
  expect_hash<geometry_msgs::Vector3>(
      "cc12fe83e4c02719f1ce8070bfd14aecd40f75a96696a67a2a1f37f7dbb0765d");
  expect_hash<geometry_msgs::Pose>(
      "d501954e9476cea2996984e812054b68026ae0bfae789d9a10b23daf35cc90fa");
  expect_hash<geometry_msgs::PoseStamped>(
      "10f3786d7d40fd2b54367835614bff85d4ad3b5dab62bf8bca0cc232d73b4cd8");
  expect_hash<geometry_msgs::PoseWithCovariance>(
      "9a7c0fd234b7f45c6098745ecccd773ca1085670e64107135397aee31c02e1bb");
  expect_hash<geometry_msgs::Transform>(
      "beb83fbe698636351461f6f35d1abb20010c43d55374d81bd041f1ba2581fddc");
  expect_hash<geometry_msgs::TransformStamped>(
      "0a241f87d04668d94099cbb5ba11691d5ad32c2f29682e4eb5653424bd275206");
  expect_hash<geometry_msgs::Twist>(
      "9c45bf16fe0983d80e3cfe750d6835843d265a9a6c46bd2e609fcddde6fb8d2a");
  expect_hash<tf2_msgs::TFMessage>(
      "e369d0f05a23ae52508854b66f6aa0437f3449d652e8cbf22d5abe85d020f087");
  expect_hash<vision_msgs::Detection3DArray>(
      "793f5eab9595ac1c0da07873cc859db42eae51f0ee76056db8562515d830e018");
  expect_hash<vision_msgs::Detection3D>(
      "ddd703be132ab0b69d33121f1bb034132bfbb3b0ac5f9fb1516005ba1c8a265b");
  expect_hash<vision_msgs::BoundingBox3D>(
      "bbb73a65c163d7f9bb29009c7bde9f7faa576bd2d23299c4511d19230dab4698");
  expect_hash<vision_msgs::ObjectHypothesis>(
      "51da43cec11c01957a64d1e05a24acd18aae7745ec30b74348ad5f6d634f7f90");
  expect_hash<vision_msgs::ObjectHypothesisWithPose>(
      "41c12344c0396c48b81df12467c192d99b2a0eb1463c5c37194e4223251c80bc");
  expect_hash<vision_msgs::VisionInfo>(
      "95d3116a17484ad91c9a2686e1d54890bbfc3ff6c6a2de137738c4950d45d284");
  expect_hash<vision_msgs::LabelInfo>(
      "3d37df4015cdf660cc851c51897f2acd957e1ca6205ba0a99aebffb9406b0783");
  expect_hash<vision_msgs::VisionClass>(
      "1e4a11f0fed50b5623cb8ff26ca0e37952a48a9c074d16f804b44e9164c2037a");
  expect_hash<visualization_msgs::Marker>(
      "45b13ccf791f225962bf74e746f9644518855d783a6f42ba0cc14fde2b4f3ce0");
  expect_hash<visualization_msgs::MarkerArray>(
      "86cb8800b6fb05b5eff1abd7a56f62a5641d3ae9a1c29e78e67e704f1d067dcf");
  expect_hash<visualization_msgs::UVCoordinate>(
      "f27f7ed21fe360c6066944f856b801a0c0d1e94e815b6886444b42d90b196a26");
  expect_hash<visualization_msgs::MeshFile>(
      "7710ece15a148fb7c9b546364cfb215bb06098087bd6394fe5b73a493508f8c4");
  expect_hash<std_msgs::ColorRGBA>(
      "77a7a5b9ae477306097665106e0413ba74440245b1f3d0c6d6405fe5c7813fe8");
  expect_hash<std_msgs::String>("df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18");
  expect_hash<diagnostic_msgs::DiagnosticArray>(
      "5a8a36efb05fb25070fa0fb3810290c0e6cd4862b54a8fb975a1ee8dc55a333e");
  expect_hash<diagnostic_msgs::DiagnosticStatus>(
      "b0e3e692ea2d54a8af2f4ef1930e81556a2db55216b771f8a7d2724ed47bf0e4");
  expect_hash<diagnostic_msgs::KeyValue>(
      "d68081eaa540288c5440753baecef0c4e16e81a5f78ad68902ded5100413bb42");
  expect_hash<rmw_dds_common::ParticipantEntitiesInfo>(
      "91a0593bacdcc50ea9bdcf849a938b128412cc1ea821245c663bcd26f83c295e");
  expect_hash<rmw_dds_common::NodeEntitiesInfo>(
      "8ffef65ee2d088c63b1e8fcd31e800ba9fc8dbe0ee15ca60d1676de5218087a7");
  expect_hash<rmw_dds_common::Gid>(
      "ab6f21cfbb0a6dbb837161e1110c2051a2850ed9f9c53944d7115d9bcebedf71");
  expect_hash<rcl_interfaces::Log>(
      "e28ce254ca8abc06abf92773b74602cdbf116ed34fbaf294fb9f81da9f318eac");
  expect_hash<rcl_interfaces::ParameterType>(
      "df29ed057a834862187be24dd187d981790ff3ea6502f4cd27b432cbc42c6d46");
  expect_hash<rcl_interfaces::ParameterEvent>(
      "043e627780fcad87a22d225bc2a037361dba713fca6a6b9f4b869a5aa0393204");
  expect_hash<std_srvs::Trigger_Request>(
      "d010825374ce8918e72bfd826c82603e60f45419e932ea976f807b74a863a199");
  expect_hash<std_srvs::Trigger_Response>(
      "2d946c21e2fc3f1e9ca6986a8191d85fcc70097a8bb7771a053564bc47009cdf");
  expect_hash<rcl_interfaces::ListParameters_Request>(
      "a1b0b5d6b967a5b8ac5bc8563c3ea678f349e312a6a4967227c5a96bc5ce38df");
  expect_hash<rcl_interfaces::ListParameters_Response>(
      "31b937b82de3612426be79f231e386259f97e8dc843e3f2845288b4bfa296bdd");
  expect_hash<rcl_interfaces::GetParameters_Request>(
      "135a9e1c3d7cebef792f6687d7ddf99949b21a0bd9a320d863a9110a3f5cf4d6");
  expect_hash<rcl_interfaces::GetParameters_Response>(
      "9fa773b46e39cc5d02db6224d8fd520bb9caeeffc2b27c96c1e59431baba9f2a");
  expect_hash<rcl_interfaces::SetParameters_Request>(
      "130d46386b7e84ea9ecf60608a4d83cbe5e5cb7c6cc5b712b7a4e3a6c254e932");
  expect_hash<rcl_interfaces::SetParameters_Response>(
      "7a0e8140a0b8d98308fa81a5403a766e610af29a239caf54b7553227906fc266");
  expect_hash<rcl_interfaces::SetParametersAtomically_Request>(
      "db0bd950ed5ed867a0e90b225e44dea382d762c0762ff3e0ee842190042a59e5");
  expect_hash<rcl_interfaces::SetParametersAtomically_Response>(
      "31b1a38c5b0b9d893ee24da45f69638f4561c78461d82d52750f429b534502b8");
  expect_hash<rcl_interfaces::DescribeParameters_Request>(
      "05dd1c2bc87dec2627105c8070d6f9725c781a4f2ab852975bf105462b82b644");
  expect_hash<rcl_interfaces::DescribeParameters_Response>(
      "ad6747319613c6131589e062e095b469a46cc764f7d0f12a001a49e6cd893995");
  expect_hash<rcl_interfaces::GetParameterTypes_Request>(
      "87d7ec5ef545d4daa289d500025d31fb2437bc8b8365ca367161c4dac4be33fd");
  expect_hash<rcl_interfaces::GetParameterTypes_Response>(
      "ac1335dce67c478e669434f6ac2fbff34fcd529580f272d3006785ba8b54e47f");
  expect_hash<rosgraph_msgs::Clock>(
      "692f7a66e93a3c83e71765d033b60349ba68023a8c689a79e48078bcb5c58564");
  expect_hash<type_description_interfaces::GetTypeDescription_Request>(
      "470f56ccbcf13d55c78c8b735fb12da03e639e5acded994426c89d94778d9e28");
  expect_hash<type_description_interfaces::GetTypeDescription_Response>(
      "648c49d976240861a482f961c5621ddd0d2135d8cce6f297a76d4f6376d93b75");
}

}  // namespace
}  // namespace bpa::wire
