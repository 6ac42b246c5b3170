#pragma once

#include <filesystem>

#include "engine/benchmark/metrics.h"
#include "engine/evaluate/truth.h"
#include "engine/pipeline/reconstruction.h"

namespace planecast::engine {

/// Figures of a reconstruction folder against the truth (null: counts and times alone). Mono maps
/// are aligned by a similarity, metric ones rigidly; the overlay is judged for content anchored by
/// a tap. Throws UserError where the folder is broken.
Metrics measure_reconstruction(const std::filesystem::path& folder, const SequenceTruth* truth);

}  // namespace planecast::engine
