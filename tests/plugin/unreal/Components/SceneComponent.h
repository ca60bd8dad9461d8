#pragma once

#include "CoreMinimal.h"

namespace EEndPlayReason {
enum Type { Destroyed };
}
enum ELevelTick { LEVELTICK_All };
struct FActorComponentTickFunction {
  bool bCanEverTick{false};
};

class USceneComponent {
 public:
  explicit USceneComponent(const FObjectInitializer& = FObjectInitializer()) {}
  USceneComponent(const USceneComponent&) = delete;
  USceneComponent& operator=(const USceneComponent&) = delete;
  virtual ~USceneComponent() = default;
  const FTransform& GetComponentTransform() const { return Transform; }
  virtual void BeginPlay() {}
  virtual void EndPlay(const EEndPlayReason::Type) {}
  virtual void TickComponent(float, ELevelTick, FActorComponentTickFunction*) {}

  FActorComponentTickFunction PrimaryComponentTick;
  FTransform Transform;  // of tests; the engine computes it from the parents
};
