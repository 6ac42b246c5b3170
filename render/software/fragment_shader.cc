#include "render/software/fragment_shader.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace planecast::render {
namespace {

constexpr float kPixelsPerStep = 1.0F / 256.0F;

/// Encoding by the square root of the linear value, which is nearly as even as sRGB itself.
class EncodeTable {
 public:
  EncodeTable() {
    for (std::size_t i = 0; i < table_.size(); ++i) {
      const float root = static_cast<float>(i) / static_cast<float>(table_.size() - 1);
      const float c = root * root;
      const float encoded =
          c <= 0.0031308F ? 12.92F * c : 1.055F * std::pow(c, 1.0F / 2.4F) - 0.055F;
      table_[i] = static_cast<std::uint8_t>(std::lround(255.0F * std::clamp(encoded, 0.0F, 1.0F)));
    }
  }
  /// 0 <= root <= 1; anything else, or what is not a number, is black.
  std::uint8_t operator()(float root) const {
    if (!(root >= 0.0F && root <= 1.0F)) return 0;
    return table_[static_cast<std::size_t>(
        static_cast<int>(root * static_cast<float>(table_.size() - 1) + 0.5F))];
  }

 private:
  std::array<std::uint8_t, 8192> table_{};
};

const EncodeTable kEncoded;

glm::vec3 xyz(const F4& v) { return {v[0], v[1], v[2]}; }

/// Perspective-correct weights of a triangle's first two corners at a point.
struct Weights {
  float a = 0.0F;
  float b = 0.0F;

  F4 mix(const glm::vec4& p, const glm::vec4& q, const glm::vec4& r) const {
    const F4 from = std::bit_cast<F4>(r);
    return from + a * (std::bit_cast<F4>(p) - from) + b * (std::bit_cast<F4>(q) - from);
  }
};

}  // namespace

FragmentShader::FragmentShader(const std::vector<ObjectSurface>& surfaces,
                               const std::vector<ObjectTriangle>& triangles,
                               const ShadingUniforms& uniforms)
    : surfaces_(&surfaces), triangles_(&triangles), uniforms_(&uniforms) {}

/// What a batch shares, such as textures, is then looked up once.
void FragmentShader::order_by_surface(std::vector<Fragment>& fragments) {
  const auto surface_of = [this](const Fragment& fragment) {
    return (*triangles_)[static_cast<std::size_t>(fragment.triangle)].surface;
  };
  first_of_surface_.assign(surfaces_->size() + 1, 0);
  for (const Fragment& fragment : fragments) ++first_of_surface_[surface_of(fragment) + 1U];
  for (std::size_t i = 1; i < first_of_surface_.size(); ++i) {
    first_of_surface_[i] += first_of_surface_[i - 1];
  }
  ordered_.resize(fragments.size());
  std::vector<std::size_t> next = first_of_surface_;
  for (Fragment& fragment : fragments) ordered_[next[surface_of(fragment)]++] = &fragment;
}

void FragmentShader::shade(std::vector<Fragment>& fragments) {
  order_by_surface(fragments);
  Batch batch;
  for (std::size_t s = 0; s < surfaces_->size(); ++s) {
    batch.surface = &(*surfaces_)[s];
    const std::size_t end = first_of_surface_[s + 1];
    for (std::size_t first = first_of_surface_[s]; first < end; first += kLanes) {
      batch.count = std::min(kLanes, end - first);
      std::copy_n(&ordered_[first], batch.count, batch.fragments.begin());
      shade(batch);
    }
  }
}

void FragmentShader::shade(const Batch& batch) {
  place(batch);
  find_weights(place_);
  interpolate(batch);
  read_albedo(batch);
  if (batch.surface->unlit) {
    show_albedo(lanes_, uniforms_->light.exposure);
  } else {
    read_maps(batch);
    orient(lanes_, uniforms_->light);
    if (uniforms_->shadow.depth != nullptr) {
      find_sun(lanes_, uniforms_->shadow);
    } else {
      lanes_.arrives.fill(1.0F);
    }
    if (uniforms_->reflections.texels != nullptr) {
      find_reflections(lanes_, uniforms_->light.eye, uniforms_->reflections);
      light_mirroring(lanes_, uniforms_->light);
    } else {
      light(lanes_, uniforms_->light);
    }
  }
  finish(batch);
  if (uniforms_->occlusion.depth != nullptr) hide(batch);
}

void FragmentShader::place(const Batch& batch) {
  const ScreenVertex* screen = batch.surface->screen;
  for (std::size_t i = 0; i < batch.count; ++i) {
    const Fragment& fragment = *batch.fragments[i];
    const ObjectTriangle& triangle = (*triangles_)[static_cast<std::size_t>(fragment.triangle)];
    const int u = 256 * fragment.x + 128;
    const int v = 256 * fragment.y + 128;
    for (std::size_t k = 0; k < 3; ++k) {
      const ScreenVertex& corner = screen[triangle.corners[k]];
      place_.u[k][i] = static_cast<float>(corner.x - u) * kPixelsPerStep;
      place_.v[k][i] = static_cast<float>(corner.y - v) * kPixelsPerStep;
      place_.inverse_w[k][i] = corner.inverse_w;
    }
  }
}

void FragmentShader::interpolate(const Batch& batch) {
  const ObjectSurface& surface = *batch.surface;
  const F4 base = std::bit_cast<F4>(surface.material->base_color);
  const bool second_set = surface.second_set();
  for (std::size_t i = 0; i < batch.count; ++i) {
    const ObjectTriangle& triangle =
        (*triangles_)[static_cast<std::size_t>(batch.fragments[i]->triangle)];
    const WorldVertex& a = surface.vertices[triangle.corners[0]];
    const WorldVertex& b = surface.vertices[triangle.corners[1]];
    const WorldVertex& c = surface.vertices[triangle.corners[2]];
    const Weights weights{place_.weight[0][i], place_.weight[1][i]};
    const F4 position_u = weights.mix({a.position, a.u0}, {b.position, b.u0}, {c.position, c.u0});
    const F4 normal_v = weights.mix({a.normal, a.v0}, {b.normal, b.v0}, {c.normal, c.v0});
    lanes_.position.set(i, xyz(position_u));
    lanes_.normal.set(i, xyz(normal_v));
    lanes_.facing[i] = triangle.front ? 1.0F : -1.0F;
    if (surface.normal.texture != nullptr) {
      const F4 tangent = weights.mix(a.tangent, b.tangent, c.tangent);
      lanes_.tangent.set(i, xyz(tangent));
      lanes_.handedness[i] = tangent[3];
    }
    const F4 color = surface.colored ? weights.mix(a.color, b.color, c.color) : F4{1, 1, 1, 1};
    lanes_.albedo.set(i, xyz(color * base));

    const auto footprint = [&](FootprintLanes& out, glm::vec2 p, glm::vec2 q, glm::vec2 r) {
      const glm::vec2 pr = p - r;
      const glm::vec2 qr = q - r;
      out.u[i] = r.x + weights.a * pr.x + weights.b * qr.x;
      out.v[i] = r.y + weights.a * pr.y + weights.b * qr.y;
      out.u_across[i] = place_.across[0][i] * pr.x + place_.across[1][i] * qr.x;
      out.v_across[i] = place_.across[0][i] * pr.y + place_.across[1][i] * qr.y;
      out.u_down[i] = place_.down[0][i] * pr.x + place_.down[1][i] * qr.x;
      out.v_down[i] = place_.down[0][i] * pr.y + place_.down[1][i] * qr.y;
    };
    footprint(points_[0], {a.u0, a.v0}, {b.u0, b.v0}, {c.u0, c.v0});
    if (second_set) footprint(points_[1], a.uv1, b.uv1, c.uv1);
  }
  if (surface.normal.texture == nullptr) lanes_.tangent = {};
}

void FragmentShader::read_albedo(const Batch& batch) {
  const SurfaceMap& map = batch.surface->base_color;
  if (map.texture == nullptr) return;
  const StretchedTaps taps = place_stretched(points_[map.slot.uv_set == 0 ? 0 : 1], batch.count,
                                             map.slot.transform, map.texture->size(), reads_);
  map.texture->read(reads_);
  Lane red;
  Lane green;
  Lane blue;
  gather_stretched(taps, batch.count, batch.surface->encoded_color, reads_, red, green, blue);
  for (std::size_t i = 0; i < batch.count; ++i) {
    lanes_.albedo.x[i] *= red[i];
    lanes_.albedo.y[i] *= green[i];
    lanes_.albedo.z[i] *= blue[i];
  }
}

void FragmentShader::read(const SurfaceMap& map) {
  place_trilinear(points_[map.slot.uv_set == 0 ? 0 : 1], map.slot.transform, map.texture->size(),
                  reads_);
  map.texture->read(reads_);
}

void FragmentShader::read_maps(const Batch& batch) {
  const ObjectSurface& surface = *batch.surface;
  const Material& material = *surface.material;
  const auto open_of = [&](float texel) {
    return 1.0F + material.occlusion_strength * (texel - 1.0F);
  };
  lanes_.metallic.fill(material.metallic);
  lanes_.roughness.fill(material.roughness);
  lanes_.open.fill(1.0F);
  // Often one texture holds both.
  const bool together =
      surface.occlusion.texture != nullptr && surface.occlusion.read_as(surface.metallic_roughness);
  if (surface.metallic_roughness.texture != nullptr) {
    read(surface.metallic_roughness);
    for (std::size_t i = 0; i < kLanes; ++i) {
      lanes_.metallic[i] *= reads_.blue[i];
      lanes_.roughness[i] *= reads_.green[i];
      if (together) lanes_.open[i] = open_of(reads_.red[i]);
    }
  }
  if (surface.occlusion.texture != nullptr && !together) {
    read(surface.occlusion);
    for (std::size_t i = 0; i < kLanes; ++i) lanes_.open[i] = open_of(reads_.red[i]);
  }
  lanes_.emissive.x.fill(material.emissive.x);
  lanes_.emissive.y.fill(material.emissive.y);
  lanes_.emissive.z.fill(material.emissive.z);
  if (surface.emissive.texture != nullptr) {
    read(surface.emissive);
    for (std::size_t i = 0; i < kLanes; ++i) {
      lanes_.emissive.x[i] *= reads_.red[i];
      lanes_.emissive.y[i] *= reads_.green[i];
      lanes_.emissive.z[i] *= reads_.blue[i];
    }
  }
  if (surface.normal.texture != nullptr) {
    read(surface.normal);
    for (std::size_t i = 0; i < kLanes; ++i) {
      lanes_.bend.x[i] = (2.0F * reads_.red[i] - 1.0F) * material.normal_scale;
      lanes_.bend.y[i] = (2.0F * reads_.green[i] - 1.0F) * material.normal_scale;
      lanes_.bend.z[i] = 2.0F * reads_.blue[i] - 1.0F;
    }
  }
}

void FragmentShader::finish(const Batch& batch) {
  for (std::size_t i = 0; i < batch.count; ++i) {
    const glm::vec3 root = lanes_.color_root.get(i);
    batch.fragments[i]->color = {kEncoded(root.x), kEncoded(root.y), kEncoded(root.z)};
  }
}

/// What lies behind the depth image fades.
void FragmentShader::hide(const Batch& batch) {
  LaneInt x{};
  LaneInt y{};
  Lane depth{};
  const glm::vec4& view = uniforms_->view_depth;
  for (std::size_t i = 0; i < batch.count; ++i) {
    x[i] = batch.fragments[i]->x + uniforms_->corner.x;
    y[i] = batch.fragments[i]->y + uniforms_->corner.y;
    depth[i] = glm::dot(glm::vec3(view), lanes_.position.get(i)) + view.w;
  }
  Lane visible;
  find_visibility(uniforms_->occlusion, x, y, depth, visible);
  for (std::size_t i = 0; i < batch.count; ++i) {
    Fragment& fragment = *batch.fragments[i];
    const auto share = [&](std::uint8_t value) {
      return static_cast<std::uint8_t>(visible[i] * static_cast<float>(value) + 0.5F);
    };
    fragment.alpha = share(255);
    for (std::uint8_t& channel : fragment.color) channel = share(channel);
  }
}

}  // namespace planecast::render
