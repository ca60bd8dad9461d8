#pragma once

#include "CoreMinimal.h"
#include "OsteonTypes.h"
#include "osteon_host.h"

/// Whether a call succeeded. A refusal is logged and broadcast. A refusal that repeats with the same text,
/// for example in each frame, is logged and broadcast only once.
inline bool OsteonSucceeds(OsteonResult Result, FString& LastRefusal, FOsteonRefused& OnRefused) {
  if (Result == OSTEON_OK) return true;
  const FString Text = UTF8_TO_TCHAR(osteon_last_error());
  if (Text != LastRefusal) {
    LastRefusal = Text;
    UE_LOG(LogTemp, Warning, TEXT("Osteon: %s"), *Text);
    OnRefused.Broadcast(Text);
  }
  return false;
}
