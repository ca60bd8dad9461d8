#pragma once

#include "Components/SceneComponent.h"
#include "CoreMinimal.h"
#include "OsteonTypes.h"
#include "osteon_host_plan.h"

#include "OsteonGuidanceComponent.generated.h"

/// Holds a hand to a surgical plan with one of its reamers: a funnel, a cone of tilt and a depth.
///
/// Places and velocities are Unreal's, in centimetres, in the bone's frame; forces are newtons. The plan is
/// opened when play begins. A haptic device's own thread may call Evaluate once in each period of a
/// millisecond: it never waits.
UCLASS(ClassGroup = (Osteon), meta = (BlueprintSpawnableComponent))
class OSTEONCUTTING_API UOsteonGuidanceComponent : public USceneComponent {
  GENERATED_BODY()

 public:
  UOsteonGuidanceComponent(const FObjectInitializer& Initializer) : USceneComponent(Initializer) {}

  /// A shipped plan, or its YAML file.
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Osteon")
  FString Plan = TEXT("acetabulum");
  /// Folder of plans/ and rubrics/; empty: that of the library.
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Osteon")
  FString ConfigFolder;
  /// Index of the plan's reamer that is in use.
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Osteon")
  int32 Reamer = 0;
  /// 0 … 1; negative: the plan's own.
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Osteon")
  double Gain = -1.0;
  /// Of guidance and the bone's force together: above 0, at most 200.
  UPROPERTY(EditAnywhere, BlueprintReadWrite, Category = "Osteon")
  double MaxForce_N = 200.0;

  /// Something was refused; the text says what was found and what is accepted. Each text once in a row.
  UPROPERTY(BlueprintAssignable, Category = "Osteon")
  FOsteonRefused OnRefused;

  /// Opens the plan and its guidance by the properties; what was open is closed.
  UFUNCTION(BlueprintCallable, Category = "Osteon")
  bool Open();
  UFUNCTION(BlueprintCallable, Category = "Osteon")
  void Close();
  UFUNCTION(BlueprintPure, Category = "Osteon")
  bool IsOpen() const { return HostGuidance.IsOpen(); }

  /// The guidance [N, N·m] to add to the other force and torque, which come first; once in each period.
  UFUNCTION(BlueprintCallable, Category = "Osteon")
  bool Evaluate(const FTransform& Pose, const FVector& Velocity, const FVector& AngularVelocity,
                const FVector& OtherForce_N, const FVector& OtherTorque_Nm, FVector& Force_N,
                FVector& Torque_Nm);
  /// How much deeper than planned the last Evaluate's tool was [mm]; at most 0: not.
  UFUNCTION(BlueprintPure, Category = "Osteon")
  double GetDepth_mm() const { return 1e3 * Last.depth_m; }
  /// Whether the last Evaluate's tool was beyond a stop of the plan: the caller should stop the spindle.
  UFUNCTION(BlueprintPure, Category = "Osteon")
  bool MustStopSpindle() const { return Last.stop_spindle != 0; }
  UFUNCTION(BlueprintCallable, Category = "Osteon")
  bool SetGain(double NewGain);
  /// Age of the contact model that the other force is made of [s]: the guidance fades with it.
  UFUNCTION(BlueprintCallable, Category = "Osteon")
  bool SetModelAge(double Age_s);
  /// Begins anew, after a change of tool or a jump of the pose.
  UFUNCTION(BlueprintCallable, Category = "Osteon")
  bool Reset();

  UFUNCTION(BlueprintPure, Category = "Osteon")
  int32 GetReamerCount() const { return static_cast<int32>(Info.values.reamer_count); }
  /// Out of the opening, of length 1.
  UFUNCTION(BlueprintPure, Category = "Osteon")
  FVector GetCupAxis() const;
  UFUNCTION(BlueprintPure, Category = "Osteon")
  FVector GetCupCenter() const;
  /// Planned place of the tool's origin with a reamer of the sequence, and the reamer's diameter.
  UFUNCTION(BlueprintCallable, Category = "Osteon")
  bool GetReamer(int32 Index, FVector& Apex, double& Diameter_mm);

  void BeginPlay() override;
  void EndPlay(const EEndPlayReason::Type Reason) override;

 private:
  bool Succeeds(OsteonResult Result);

  osteon::host::Plan HostPlan{osteon::host::kUnreal};
  osteon::host::Guidance HostGuidance{osteon::host::kUnreal};
  osteon::host::PlanInfo Info{};
  OsteonGuidanceOutput Last{};
  FString LastRefusal;
};
