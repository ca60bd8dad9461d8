#pragma once

#include <memory>
#include <vector>

#include "Components/SceneComponent.h"
#include "CoreMinimal.h"

// Unreal's actor, as far as the plug-in uses it.

class AActor {
 public:
  using Super = AActor;  // derived classes call their base by this name
  AActor() = default;
  AActor(const AActor&) = delete;
  AActor& operator=(const AActor&) = delete;
  virtual ~AActor() = default;
  virtual void Tick(float) {}
  template <class T>
  T* CreateDefaultSubobject(const TCHAR*) {
    auto made = std::make_unique<T>(FObjectInitializer());
    T* const given = made.get();
    components_.push_back(std::move(made));
    return given;
  }

  FActorComponentTickFunction PrimaryActorTick;
  USceneComponent* RootComponent{nullptr};

 private:
  std::vector<std::unique_ptr<USceneComponent>> components_;
};
