#pragma once

#include "CoreMinimal.h"
#include "GameFramework/Actor.h"
#include "OsteonBoneComponent.h"

#include "OsteonReamCup.generated.h"

/// A sample: place this actor in a level and play. Its reamer moves into the shipped acetabulum and back
/// within ten seconds. The bone's mesh follows the cut, and the log reports force and volume at each turning
/// point.
UCLASS()
class OSTEONCUTTING_API AOsteonReamCup : public AActor {
  GENERATED_BODY()

 public:
  AOsteonReamCup();

  UPROPERTY(VisibleAnywhere, BlueprintReadOnly, Category = "Osteon")
  UOsteonBoneComponent* Bone = nullptr;
  /// Component whose origin is the reamer's apex; attach a mesh to see the reamer.
  UPROPERTY(VisibleAnywhere, BlueprintReadOnly, Category = "Osteon")
  USceneComponent* Tool = nullptr;
  /// Speed of the feed.
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Osteon")
  double Feed_mm_per_s = 2.0;

  /// The largest force [N] along the bone's +z, out of the cup, so far.
  UFUNCTION(BlueprintPure, Category = "Osteon")
  double GetLargestForce_N() const { return LargestForce_N; }

  void Tick(float DeltaTime) override;

 private:
  double Seconds = 0.0;
  double LargestForce_N = 0.0;
};
