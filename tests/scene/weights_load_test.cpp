#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include <random>

#include "support/scene_files.h"
#include "support/shipped_scene.h"

namespace tactus {
namespace {

/// Without a cost of joint limits: some of these weights make it too steep.
JointVector weightsOf(const std::vector<double>& weights) {
  return test::shippedScene("scenario1_weighted",
                            {{"redundancy.weights", fmt::format("[{}]", fmt::join(weights, ", "))},
                             {"redundancy.joint_limit_avoidance.gain", "0"}})
      .controller.weights;
}

TEST(WeightsLoad, KeepsTheShippedOnesToTheBit) {
  const JointVector shipped = test::shippedScene("scenario1_weighted").controller.weights;
  EXPECT_EQ(shipped, (JointVector(9) << 4, 1, 1, 2, 1, 0.5, 0.5, 0.25, 0.25).finished());
}

TEST(WeightsLoad, TakesEqualOnesForNoneToTheBit) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> exponent(-5.9, 5.9);
  for (int i = 0; i < 20; ++i) {
    const double weight = std::pow(10.0, exponent(random));
    EXPECT_EQ(weightsOf(std::vector(9, weight)), JointVector(JointVector::Ones(9))) << weight;
  }
}

TEST(WeightsLoad, ForgetsACommonFactorAndKeepsTheRatios) {
  std::mt19937 random(12);
  std::uniform_real_distribution<double> exponent(-2.0, 2.0);
  for (int i = 0; i < 20; ++i) {
    std::vector<double> weights(9), scaled;
    for (double& weight : weights) weight = std::pow(10.0, exponent(random));
    const double factor = std::pow(10.0, exponent(random));
    for (const double weight : weights) scaled.push_back(factor * weight);
    const JointVector loaded = weightsOf(weights);
    EXPECT_TRUE(loaded.isApprox(weightsOf(scaled), 1e-14));
    EXPECT_NEAR(loaded[3] / loaded[7], weights[3] / weights[7], 1e-12 * weights[3] / weights[7]);
  }
}

/// Of an even number the middle is between two, of which none may be chosen over the other.
TEST(WeightsLoad, TakesTheMiddleOfAnEvenNumber) {
  const JointVector weights = loadScene(TACTUS_SOURCE_DIR "/config/scenes/robots/planar2_free.yaml",
                                        {{"redundancy.weights", "[2, 8]"}})
                                  .controller.weights;
  EXPECT_EQ(weights, Eigen::Vector2d(0.5, 2.0));
}

}  // namespace
}  // namespace tactus
