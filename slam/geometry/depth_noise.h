#pragma once

namespace planecast::slam {

/// Standard deviation, in metres, of a structured-light depth along z; axial model of Nguyen et
/// al., "Modeling Kinect Sensor Noise for Improved 3D Reconstruction and Tracking" (3DIMPVT 2012).
/// Domain: 0.4 m and more.
inline double depth_sigma_m(double z_m) {
  const double beyond = z_m - 0.4;
  return 0.0012 + 0.0019 * beyond * beyond;
}

}  // namespace planecast::slam
