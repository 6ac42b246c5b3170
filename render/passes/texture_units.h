#pragma once

namespace planecast::render {

/// Which texture sits on which unit, for all programs.
enum TextureUnit : unsigned {
  kUnitBaseColor = 0,
  kUnitMetallicRoughness = 1,
  kUnitNormal = 2,
  kUnitOcclusion = 3,
  kUnitEmissive = 4,
  kUnitShadowCompare = 5,
  kUnitShadowRaw = 6,
  kUnitOccluderDepth = 7,
  kUnitMask = 8,
  kUnitHeights = 9,
  kUnitContact = 10,
  kUnitSpecular = 11,
  kUnitSpecularColor = 12,
  kUnitTransmission = 13,
  kUnitClearcoat = 14,
  kUnitClearcoatRoughness = 15,
  kUnitClearcoatNormal = 16,
  kUnitSheenColor = 17,
  kUnitSheenRoughness = 18,
  kUnitBaked = 19,
  kUnitEnvironment = 20,
};

}  // namespace planecast::render
