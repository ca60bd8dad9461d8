#pragma once

#include "CoreMinimal.h"

// Unreal's scene component, as far as the plug-in uses it (see CoreMinimal.h).

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
  void SetupAttachment(USceneComponent* Parent) { AttachParent = Parent; }
  /// Takes the parents to be at the origin.
  void SetRelativeTransform(const FTransform& Relative) { Transform = Relative; }
  virtual void BeginPlay() {}
  virtual void EndPlay(const EEndPlayReason::Type) {}
  virtual void TickComponent(float, ELevelTick, FActorComponentTickFunction*) {}

  FActorComponentTickFunction PrimaryComponentTick;
  USceneComponent* AttachParent{nullptr};
  FTransform Transform;  // set by tests; the engine computes it from the parents
};
