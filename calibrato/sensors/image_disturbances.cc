#include "calibrato/sensors/image_disturbances.h"

namespace calibrato {

ImageDisturbances ImageDisturbancesFromValue(const Value& value,
                                             std::vector<std::string>* warnings) {
  if (warnings != nullptr) {
    const std::vector<std::string> unknown = value.UnknownKeys(
        {"line_delay_s", "read_noise", "shot_noise", "vignetting", "lighting_gradient",
         "defocus_px", "stamp_jitter_s", "drop_probability", "exposure_variation"});
    warnings->insert(warnings->end(), unknown.begin(), unknown.end());
  }
  // @param most  What the number must not exceed.
  const auto read = [&](const char* key, double most, double* number) {
    const Value* x = value.Find(key);
    if (x == nullptr) return;
    *number = x->AsNonNegative();
    if (!(*number <= most)) {
      x->Fail("too large a disturbance of the images", "the most is " + FormatNumber(most),
              "make it smaller");
    }
  };
  ImageDisturbances images;
  read("line_delay_s", 1e-3, &images.line_delay_s);
  read("read_noise", 255.0, &images.read_noise);
  read("shot_noise", 255.0, &images.shot_noise);
  read("vignetting", 1.0, &images.vignetting);
  read("defocus_px", 20.0, &images.defocus_px);
  read("stamp_jitter_s", 0.1, &images.stamp_jitter_s);
  read("drop_probability", 1.0, &images.drop_probability);
  read("exposure_variation", 1.0, &images.exposure_variation);
  if (const Value* x = value.Find("lighting_gradient")) {
    images.lighting_gradient = Eigen::Vector2d(x->AsDoubles(2).data());
    if (!(images.lighting_gradient.cwiseAbs().sum() <= 1.0)) {
      x->Fail("too steep a lighting gradient", "its two numbers add up to more than 1",
              "make them smaller");
    }
  }
  return images;
}

Value ToValue(const ImageDisturbances& disturbances) {
  Value value = Value::Object();
  value.Set("line_delay_s", disturbances.line_delay_s)
      .Set("read_noise", disturbances.read_noise)
      .Set("shot_noise", disturbances.shot_noise)
      .Set("vignetting", disturbances.vignetting)
      .Set("lighting_gradient", Value::Numbers(disturbances.lighting_gradient))
      .Set("defocus_px", disturbances.defocus_px)
      .Set("stamp_jitter_s", disturbances.stamp_jitter_s)
      .Set("drop_probability", disturbances.drop_probability)
      .Set("exposure_variation", disturbances.exposure_variation);
  return value;
}

}  // namespace calibrato
