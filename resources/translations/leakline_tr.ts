<?xml version="1.0" encoding="utf-8"?>
<!DOCTYPE TS>
<TS version="2.1" language="tr_TR" sourcelanguage="en">
<context>
    <name>Actions</name>
    <message>
        <source>&amp;Edit</source>
        <translation>Dü&amp;zen</translation>
    </message>
    <message>
        <source>&amp;File</source>
        <translation>&amp;Dosya</translation>
    </message>
    <message>
        <source>&amp;Help</source>
        <translation>&amp;Yardım</translation>
    </message>
    <message>
        <source>&amp;Playback</source>
        <translation>Din&amp;leme</translation>
    </message>
    <message>
        <source>&amp;Review</source>
        <translation>De&amp;ğerlendirme</translation>
    </message>
    <message>
        <source>&amp;View</source>
        <translation>&amp;Görünüm</translation>
    </message>
    <message>
        <source>Add a candidate at the cursor that the machine missed; while recording, what is passed now</source>
        <translation>Programın kaçırdığı bir adayı imlecin yerine ekler; kayıt sırasında o an geçilen yeri işaretler</translation>
    </message>
    <message>
        <source>Add a tie point at the cursor: a place the device is known to have passed then</source>
        <translation>İmleçte bir bağlama noktası ekler: cihazın o anda geçtiği bilinen bir yer</translation>
    </message>
    <message>
        <source>All keys on one sheet</source>
        <translation>Bütün tuşlar tek sayfada</translation>
    </message>
    <message>
        <source>All of the sound, the leak band, or the band of the selected candidate</source>
        <translation>Sesin tamamı, kaçak bandı ya da seçili adayın bandı</translation>
    </message>
    <message>
        <source>Arrange panels, tabs and dividers as they were the first time</source>
        <translation>Panelleri, sekmeleri ve ayırıcıları ilk hâline getirir</translation>
    </message>
    <message>
        <source>Attach photos…</source>
        <translation>Fotoğraf ekle…</translation>
    </message>
    <message>
        <source>Attach pictures of the place to the selected leak; they can also be dropped on the page</source>
        <translation>Seçili kaçağa yerin fotoğraflarını ekle; fotoğraflar sayfaya sürüklenip bırakılabilir de</translation>
    </message>
    <message>
        <source>Attach the picture in the clipboard to the selected leak</source>
        <translation>Panodaki resmi seçili kaçağa ekle</translation>
    </message>
    <message>
        <source>Begin a selection at the cursor; the second time, end it there</source>
        <translation>İmleçte bir seçim başlatır; ikinci basışta orada bitirir</translation>
    </message>
    <message>
        <source>Begin measuring at the cursor; the second time, end there; the third time, remove it</source>
        <translation>Ölçmeye imleçte başlar; ikinci basışta orada bitirir; üçüncüde ölçüyü kaldırır</translation>
    </message>
    <message>
        <source>Begin the recording; to stop it, press twice within three seconds</source>
        <translation>Kaydı başlatır; durdurmak için üç saniye içinde iki kez basın</translation>
    </message>
    <message>
        <source>Brighter</source>
        <translation>Daha parlak</translation>
    </message>
    <message>
        <source>Bring the cursor and all views to the selected candidate</source>
        <translation>İmleci ve bütün görünümleri seçili adaya getirir</translation>
    </message>
    <message>
        <source>Change the colours of the spectrogram</source>
        <translation>Spektrogramın renklerini değiştirir</translation>
    </message>
    <message>
        <source>Choose a note that was written in this survey already</source>
        <translation>Bu ölçümde daha önce yazılmış bir notu seç</translation>
    </message>
    <message>
        <source>Choose class and least score of the candidates that the list shows</source>
        <translation>Listede gösterilecek adayların sınıfını ve en düşük puanını seç</translation>
    </message>
    <message>
        <source>Choose which panels this page shows</source>
        <translation>Bu sayfanın hangi panelleri göstereceğini seçin</translation>
    </message>
    <message>
        <source>Class</source>
        <translation>Sınıf</translation>
    </message>
    <message>
        <source>Clear filter</source>
        <translation>Süzgeci kaldır</translation>
    </message>
    <message>
        <source>Clear verdict</source>
        <translation>Kararı temizle</translation>
    </message>
    <message>
        <source>Clip light out</source>
        <translation>Taşma ışığını söndür</translation>
    </message>
    <message>
        <source>Close Leakline; nothing is lost</source>
        <translation>Leakline'ı kapatır; hiçbir şey kaybolmaz</translation>
    </message>
    <message>
        <source>Close survey</source>
        <translation>Ölçümü kapat</translation>
    </message>
    <message>
        <source>Close this survey; everything is saved already</source>
        <translation>Bu ölçümü kapatır; her şey zaten kaydedildi</translation>
    </message>
    <message>
        <source>Compare</source>
        <translation>Karşılaştır</translation>
    </message>
    <message>
        <source>Compare runs</source>
        <translation>Ölçümleri karşılaştır</translation>
    </message>
    <message>
        <source>Compare with the selection</source>
        <translation>Seçimle karşılaştır</translation>
    </message>
    <message>
        <source>Compute path and leaks again with the present form and tie points; decisions are carried over</source>
        <translation>Yolu ve kaçakları şimdiki form ve bağlama noktalarıyla yeniden hesaplar; kararlar korunur</translation>
    </message>
    <message>
        <source>Confirm</source>
        <translation>Onayla</translation>
    </message>
    <message>
        <source>Contrast</source>
        <translation>Kontrast</translation>
    </message>
    <message>
        <source>Correlator</source>
        <translation>Korelatör</translation>
    </message>
    <message>
        <source>Cursor back</source>
        <translation>İmleci geri al</translation>
    </message>
    <message>
        <source>Cursor back 1 s</source>
        <translation>İmleci 1 s geri al</translation>
    </message>
    <message>
        <source>Cursor back 10 s</source>
        <translation>İmleci 10 s geri al</translation>
    </message>
    <message>
        <source>Cursor forward</source>
        <translation>İmleci ilerlet</translation>
    </message>
    <message>
        <source>Cursor forward 1 s</source>
        <translation>İmleci 1 s ilerlet</translation>
    </message>
    <message>
        <source>Cursor forward 10 s</source>
        <translation>İmleci 10 s ilerlet</translation>
    </message>
    <message>
        <source>Data page</source>
        <translation>Veri sayfası</translation>
    </message>
    <message>
        <source>Demonstration survey</source>
        <translation>Tanıtım ölçümü</translation>
    </message>
    <message>
        <source>Differences between reviewers</source>
        <translation>İnceleyenler arasındaki farklar</translation>
    </message>
    <message>
        <source>Digs</source>
        <translation>Kazılar</translation>
    </message>
    <message>
        <source>Do the change again that was taken back</source>
        <translation>Geri alınan değişikliği yeniden yapar</translation>
    </message>
    <message>
        <source>Enter what a dig showed beside what was stated, see all digs and what they say of the intervals; pressed again, go back</source>
        <translation>Kazıda çıkanı bildirilen yerin yanına yazar; bütün kazıları ve aralıklar için ne söylediklerini gösterir; yeniden basınca geri döner</translation>
    </message>
    <message>
        <source>Everything needed for the verdicts</source>
        <translation>Karar için gereken her şey</translation>
    </message>
    <message>
        <source>Export</source>
        <translation>Dışa aktar</translation>
    </message>
    <message>
        <source>Export report and files</source>
        <translation>Raporu ve dosyaları dışa aktar</translation>
    </message>
    <message>
        <source>Files, findings, form and tie points</source>
        <translation>Dosyalar, bulgular, form ve bağlama noktaları</translation>
    </message>
    <message>
        <source>Filter by class and score…</source>
        <translation>Sınıfa ve puana göre süz…</translation>
    </message>
    <message>
        <source>Find a leak between two fixed sensors from their recordings</source>
        <translation>İki sabit algılayıcının kayıtlarından aralarındaki kaçağı bulun</translation>
    </message>
    <message>
        <source>Five hints</source>
        <translation>Beş ipucu</translation>
    </message>
    <message>
        <source>Fixed contrast</source>
        <translation>Sabit kontrast</translation>
    </message>
    <message>
        <source>Follow the playback</source>
        <translation>Dinlemeyi izle</translation>
    </message>
    <message>
        <source>Found at the dig</source>
        <translation>Kazıda bulunan</translation>
    </message>
    <message>
        <source>Full screen</source>
        <translation>Tam ekran</translation>
    </message>
    <message>
        <source>Gallery</source>
        <translation>Galeri</translation>
    </message>
    <message>
        <source>Give the whole screen to the spectrogram; Escape goes back</source>
        <translation>Bütün ekranı spektrograma verir; Esc geri döner</translation>
    </message>
    <message>
        <source>Go on without the mapped route; the path is computed again</source>
        <translation>Haritadaki güzergâh olmadan sürdür; yol yeniden hesaplanır</translation>
    </message>
    <message>
        <source>Go one candidate down the list</source>
        <translation>Listede bir aday aşağı gider</translation>
    </message>
    <message>
        <source>Go one candidate up the list</source>
        <translation>Listede bir aday yukarı gider</translation>
    </message>
    <message>
        <source>Go to candidate</source>
        <translation>Adaya git</translation>
    </message>
    <message>
        <source>Go to the candidate above without a verdict</source>
        <translation>Yukarıdaki karar bekleyen adaya git</translation>
    </message>
    <message>
        <source>Go to the next candidate without a verdict</source>
        <translation>Karar verilmemiş sonraki adaya gider</translation>
    </message>
    <message>
        <source>Half and quarter speed at the same pitch, then full speed again</source>
        <translation>Aynı perdede yarım ve çeyrek hız, sonra yeniden tam hız</translation>
    </message>
    <message>
        <source>Hear and see the sound without the noise of the ball's own rolling, or as it was recorded</source>
        <translation>Sesi topun kendi yuvarlanma gürültüsü olmadan ya da kaydedildiği gibi dinleyin ve görün</translation>
    </message>
    <message>
        <source>Hide more of what is quiet</source>
        <translation>Kısık sesleri daha çok gizle</translation>
    </message>
    <message>
        <source>Import route…</source>
        <translation>Güzergâh al…</translation>
    </message>
    <message>
        <source>It is a leak; go to the next undecided</source>
        <translation>Bu bir kaçak; karar bekleyen sonraki adaya geçer</translation>
    </message>
    <message>
        <source>It is no leak; go to the next undecided</source>
        <translation>Kaçak değil; karar bekleyen sonraki adaya geçer</translation>
    </message>
    <message>
        <source>Keys</source>
        <translation>Tuşlar</translation>
    </message>
    <message>
        <source>Language, colours, size of letters, units, and your company on the report</source>
        <translation>Dil, renkler, yazı boyu, birimler ve rapordaki firma bilgileriniz</translation>
    </message>
    <message>
        <source>Leaks page</source>
        <translation>Kaçaklar sayfası</translation>
    </message>
    <message>
        <source>Leave it open for a second look; go to the next undecided</source>
        <translation>İkinci bir bakış için açık bırakır; karar bekleyen sonraki adaya geçer</translation>
    </message>
    <message>
        <source>Let a drag in any view measure instead of pan</source>
        <translation>Her görünümde sürüklemek kaydırmaz, ölçer</translation>
    </message>
    <message>
        <source>Let a drag in the spectrogram select instead of pan</source>
        <translation>Spektrogramda sürüklemek kaydırmak yerine seçim yapar</translation>
    </message>
    <message>
        <source>Let a second person judge without seeing the first verdicts; again: end it and compare</source>
        <translation>İkinci bir kişi ilk kararları görmeden karar versin; yeniden basınca biter ve karşılaştırılır</translation>
    </message>
    <message>
        <source>Let the colours begin 3 dB louder; that is kept</source>
        <translation>Renkler 3 dB daha yüksekten başlar; bu hatırlanır</translation>
    </message>
    <message>
        <source>Let the colours begin 3 dB quieter; that is kept</source>
        <translation>Renkler 3 dB daha kısıktan başlar; bu hatırlanır</translation>
    </message>
    <message>
        <source>Let the colours end 3 dB louder; that is kept</source>
        <translation>Renkler 3 dB daha yüksekte biter; bu hatırlanır</translation>
    </message>
    <message>
        <source>Let the colours end 3 dB quieter; that is kept</source>
        <translation>Renkler 3 dB daha kısıkta biter; bu hatırlanır</translation>
    </message>
    <message>
        <source>Let the colours fit what is visible now; they stay so, and the bar says auto</source>
        <translation>Renkleri şu an görünene göre ayarlar; öyle kalır, çubukta "oto" yazar</translation>
    </message>
    <message>
        <source>Let the colours span the fixed decibels again, the same for every recording</source>
        <translation>Renkler yine sabit desibel aralığını gösterir; her kayıtta aynıdır</translation>
    </message>
    <message>
        <source>Let the cursor move the other end of what is measured</source>
        <translation>İmleç, ölçünün öbür ucunu taşır</translation>
    </message>
    <message>
        <source>Listen on arrival</source>
        <translation>Gelince dinle</translation>
    </message>
    <message>
        <source>Manual</source>
        <translation>Kılavuz</translation>
    </message>
    <message>
        <source>Mark</source>
        <translation>İşaretle</translation>
    </message>
    <message>
        <source>Mark a leak here</source>
        <translation>Buraya kaçak işareti koy</translation>
    </message>
    <message>
        <source>Measure</source>
        <translation>Ölç</translation>
    </message>
    <message>
        <source>Measure by dragging</source>
        <translation>Sürükleyerek ölç</translation>
    </message>
    <message>
        <source>Measure from here</source>
        <translation>Buradan ölç</translation>
    </message>
    <message>
        <source>Measure the selection as A, against what lies around it</source>
        <translation>Seçimi A olarak, çevresiyle karşılaştırarak ölçer</translation>
    </message>
    <message>
        <source>Measure the selection as B</source>
        <translation>Seçimi B olarak ölçer</translation>
    </message>
    <message>
        <source>Metres or seconds</source>
        <translation>Metre ya da saniye</translation>
    </message>
    <message>
        <source>Move mark back</source>
        <translation>İşareti geriye kaydır</translation>
    </message>
    <message>
        <source>Move mark forward</source>
        <translation>İşareti ileriye kaydır</translation>
    </message>
    <message>
        <source>Move mark to the cursor</source>
        <translation>İşareti imlece taşı</translation>
    </message>
    <message>
        <source>Move the cursor one second back</source>
        <translation>İmleci bir saniye geri alır</translation>
    </message>
    <message>
        <source>Move the cursor one second forward</source>
        <translation>İmleci bir saniye ilerletir</translation>
    </message>
    <message>
        <source>Move the cursor one step back: a fiftieth of what is shown</source>
        <translation>İmleci bir adım geri alır: görünenin ellide biri</translation>
    </message>
    <message>
        <source>Move the cursor one step forward: a fiftieth of what is shown</source>
        <translation>İmleci bir adım ilerletir: görünenin ellide biri</translation>
    </message>
    <message>
        <source>Move the cursor ten seconds back</source>
        <translation>İmleci on saniye geri alır</translation>
    </message>
    <message>
        <source>Move the cursor ten seconds forward</source>
        <translation>İmleci on saniye ilerletir</translation>
    </message>
    <message>
        <source>Move the other end</source>
        <translation>Öbür ucu taşı</translation>
    </message>
    <message>
        <source>Move the selected mark a fiftieth of what is shown away from the launch</source>
        <translation>Seçili işareti, görünenin ellide biri kadar bırakma noktasından uzağa kaydır</translation>
    </message>
    <message>
        <source>Move the selected mark a fiftieth of what is shown towards the launch</source>
        <translation>Seçili işareti, görünenin ellide biri kadar bırakma noktasına doğru kaydır</translation>
    </message>
    <message>
        <source>Next candidate</source>
        <translation>Sonraki aday</translation>
    </message>
    <message>
        <source>Next colours</source>
        <translation>Sonraki renkler</translation>
    </message>
    <message>
        <source>Next filter of the list</source>
        <translation>Listenin sonraki süzgeci</translation>
    </message>
    <message>
        <source>Next theme: sun for outdoors, light, dark</source>
        <translation>Sonraki tema: dışarısı için güneş, açık, koyu</translation>
    </message>
    <message>
        <source>Next undecided</source>
        <translation>Karar bekleyen sonraki</translation>
    </message>
    <message>
        <source>Note</source>
        <translation>Not</translation>
    </message>
    <message>
        <source>Note used before</source>
        <translation>Önceki notlardan yaz</translation>
    </message>
    <message>
        <source>Open</source>
        <translation>Aç</translation>
    </message>
    <message>
        <source>Open a device folder or a saved survey</source>
        <translation>Cihaz klasörünü ya da kayıtlı bir ölçümü açar</translation>
    </message>
    <message>
        <source>Open folder…</source>
        <translation>Klasör aç…</translation>
    </message>
    <message>
        <source>Open the simulated survey that comes with Leakline</source>
        <translation>Leakline ile gelen benzetim ölçümünü açar</translation>
    </message>
    <message>
        <source>Opinions of a colleague…</source>
        <translation>İş arkadaşının görüşleri…</translation>
    </message>
    <message>
        <source>Pan back</source>
        <translation>Geriye kaydır</translation>
    </message>
    <message>
        <source>Pan forward</source>
        <translation>İleriye kaydır</translation>
    </message>
    <message>
        <source>Pan plan north</source>
        <translation>Planı kuzeye kaydır</translation>
    </message>
    <message>
        <source>Pan plan south</source>
        <translation>Planı güneye kaydır</translation>
    </message>
    <message>
        <source>Panels…</source>
        <translation>Paneller…</translation>
    </message>
    <message>
        <source>Paste a photo</source>
        <translation>Fotoğraf yapıştır</translation>
    </message>
    <message>
        <source>Path page</source>
        <translation>Yol sayfası</translation>
    </message>
    <message>
        <source>Photos</source>
        <translation>Fotoğraflar</translation>
    </message>
    <message>
        <source>Plan and profile large</source>
        <translation>Büyük plan ve profil</translation>
    </message>
    <message>
        <source>Play candidate in a loop</source>
        <translation>Adayı tekrarlayarak çal</translation>
    </message>
    <message>
        <source>Play each candidate in a loop as soon as it is selected, or only by key</source>
        <translation>Her adayı seçilir seçilmez tekrarlı çal ya da yalnızca tuşla çal</translation>
    </message>
    <message>
        <source>Play or pause</source>
        <translation>Çal ya da duraklat</translation>
    </message>
    <message>
        <source>Play selection in a loop</source>
        <translation>Seçimi tekrar tekrar çal</translation>
    </message>
    <message>
        <source>Play the selected candidate again and again, with two seconds of lead-in</source>
        <translation>Seçili adayı iki saniye öncesinden başlayarak durmadan tekrarlar</translation>
    </message>
    <message>
        <source>Play the sound from the cursor, or pause</source>
        <translation>Sesi imleçten başlayarak çalar ya da duraklatır</translation>
    </message>
    <message>
        <source>Play what is selected in the sound again and again; without a selection, the candidate</source>
        <translation>Seste seçili olanı tekrar tekrar çalar; seçim yoksa adayı</translation>
    </message>
    <message>
        <source>Previous candidate</source>
        <translation>Önceki aday</translation>
    </message>
    <message>
        <source>Previous undecided</source>
        <translation>Önceki karar bekleyen</translation>
    </message>
    <message>
        <source>Process again</source>
        <translation>Yeniden işle</translation>
    </message>
    <message>
        <source>Put another run of the same pipe beside this one in metres: new, gone, grown; A hears one and the other, G goes to the leak; pressed again, go back</source>
        <translation>Aynı hattın başka bir ölçümünü metre metre bunun yanına koyar: yeni, kaybolan, güçlenen; A birini ve ötekini dinletir, G kaçağa gider; yeniden basınca geri döner</translation>
    </message>
    <message>
        <source>Put out the light that says the sound was too loud</source>
        <translation>Sesin fazla yüksek geldiğini bildiren ışığı söndürür</translation>
    </message>
    <message>
        <source>Put the selected mark where the cursor is</source>
        <translation>Seçili işareti imlecin olduğu yere koy</translation>
    </message>
    <message>
        <source>Quit</source>
        <translation>Çık</translation>
    </message>
    <message>
        <source>Raw or cleaned</source>
        <translation>Ham ya da temizlenmiş</translation>
    </message>
    <message>
        <source>Recent surveys, recording, demonstration; what is open stays open</source>
        <translation>Son ölçümler, kayıt, tanıtım; açık olan açık kalır</translation>
    </message>
    <message>
        <source>Record</source>
        <translation>Kayıt</translation>
    </message>
    <message>
        <source>Record or stop</source>
        <translation>Kaydı başlat veya durdur</translation>
    </message>
    <message>
        <source>Record…</source>
        <translation>Kayıt…</translation>
    </message>
    <message>
        <source>Redo</source>
        <translation>Yinele</translation>
    </message>
    <message>
        <source>Reject</source>
        <translation>Reddet</translation>
    </message>
    <message>
        <source>Reject all undecided candidates of the list below a score, in one step</source>
        <translation>Listedeki karar bekleyen adaylardan puanı düşük olanların hepsini tek adımda reddet</translation>
    </message>
    <message>
        <source>Reject below a score…</source>
        <translation>Puanı düşük olanları reddet…</translation>
    </message>
    <message>
        <source>Remove route</source>
        <translation>Güzergâhı kaldır</translation>
    </message>
    <message>
        <source>Report page</source>
        <translation>Rapor sayfası</translation>
    </message>
    <message>
        <source>Reset layout</source>
        <translation>Düzeni sıfırla</translation>
    </message>
    <message>
        <source>Save diagnostics…</source>
        <translation>Tanılama dosyası kaydet…</translation>
    </message>
    <message>
        <source>Say what each step still lacks, and lead there</source>
        <translation>Her adımda neyin eksik olduğunu söyler ve oraya götürür</translation>
    </message>
    <message>
        <source>Say what it is: leak, valve, bend, pump …</source>
        <translation>Ne olduğunu belirtin: kaçak, vana, dirsek, pompa …</translation>
    </message>
    <message>
        <source>Scale of frequencies</source>
        <translation>Frekans ölçeği</translation>
    </message>
    <message>
        <source>Second review, blind</source>
        <translation>İkinci inceleme (kör)</translation>
    </message>
    <message>
        <source>See the report's pages</source>
        <translation>Raporun sayfalarını gör</translation>
    </message>
    <message>
        <source>Select by dragging</source>
        <translation>Sürükleyerek seç</translation>
    </message>
    <message>
        <source>Selection from here</source>
        <translation>Buradan seç</translation>
    </message>
    <message>
        <source>Settings…</source>
        <translation>Ayarlar…</translation>
    </message>
    <message>
        <source>Short events, steady sounds, excess</source>
        <translation>Kısa olaylar, sürekli sesler, fazlalık</translation>
    </message>
    <message>
        <source>Show all</source>
        <translation>Tümünü göster</translation>
    </message>
    <message>
        <source>Show all candidates as pictures in metres, or go back; arrows choose, Enter opens, Z and X change the size</source>
        <translation>Tüm adayları metre ölçeğinde resimler olarak göster ya da geri dön; oklar seçer, Enter açar, Z ve X boyu değiştirir</translation>
    </message>
    <message>
        <source>Show all candidates in the list again</source>
        <translation>Listede yine bütün adayları göster</translation>
    </message>
    <message>
        <source>Show all candidates, or only the undecided, unsure, confirmed or rejected ones</source>
        <translation>Bütün adayları ya da yalnızca karar bekleyen, kararsız, onaylanan veya reddedilenleri göster</translation>
    </message>
    <message>
        <source>Show each page of the report as it will be, before anything is written</source>
        <translation>Bir şey yazılmadan önce raporun her sayfasını olacağı gibi gösterir</translation>
    </message>
    <message>
        <source>Show half a view of what lies after, or east on the plan; the cursor stays (Shift and wheel)</source>
        <translation>Yarım görünüm sonrasını, planda doğuyu gösterir; imleç yerinde kalır (Shift ve tekerlek)</translation>
    </message>
    <message>
        <source>Show half a view of what lies before, or west on the plan; the cursor stays (Shift and wheel)</source>
        <translation>Yarım görünüm öncesini, planda batıyı gösterir; imleç yerinde kalır (Shift ve tekerlek)</translation>
    </message>
    <message>
        <source>Show half of it, or of the plan if that is in front (wheel, two fingers)</source>
        <translation>Yarısını gösterir; plan öndeyse planın yarısını (tekerlek, iki parmak)</translation>
    </message>
    <message>
        <source>Show half of the frequencies, or of the values of the plot in front (Ctrl and wheel)</source>
        <translation>Frekansların ya da öndeki çizimin değerlerinin yarısını gösterir (Ctrl ve tekerlek)</translation>
    </message>
    <message>
        <source>Show more of what is quiet</source>
        <translation>Kısık sesleri daha çok göster</translation>
    </message>
    <message>
        <source>Show short events, steady sounds, or what is over the local background</source>
        <translation>Kısa olayları, sürekli sesleri ya da yerel arka planın üstünde kalanı gösterir</translation>
    </message>
    <message>
        <source>Show sound and motion along the pipe in metres, or in time</source>
        <translation>Sesi ve hareketi boru boyunca metreyle ya da zamanla gösterir</translation>
    </message>
    <message>
        <source>Show the hints of the first start again; pressed again, the next one</source>
        <translation>İlk açılıştaki ipuçlarını yeniden gösterir; yeniden basınca sonrakini</translation>
    </message>
    <message>
        <source>Show the photos of the selected leak, or the list again</source>
        <translation>Seçili kaçağın fotoğraflarını ya da yeniden listeyi göster</translation>
    </message>
    <message>
        <source>Show the recording page: devices, levels, live path</source>
        <translation>Kayıt sayfasını açar: cihazlar, seviyeler, canlı yol</translation>
    </message>
    <message>
        <source>Show the whole run (double click; on a leak it goes there)</source>
        <translation>Bütün ölçümü gösterir (çift tıklama; bir kaçağın üstünde oraya gider)</translation>
    </message>
    <message>
        <source>Show twice as many frequencies, or values of the plot in front (Ctrl and wheel)</source>
        <translation>Frekansların ya da öndeki çizimin değerlerinin iki katını gösterir (Ctrl ve tekerlek)</translation>
    </message>
    <message>
        <source>Show twice as much, or of the plan if that is in front (wheel, two fingers)</source>
        <translation>İki katını gösterir; plan öndeyse planın iki katını (tekerlek, iki parmak)</translation>
    </message>
    <message>
        <source>Show what speaks for and against a leak here, or the list again</source>
        <translation>Burada kaçaktan yana ve kaçağa karşı olanı göster, ya da yine listeyi</translation>
    </message>
    <message>
        <source>Show where the second reviewer differs, side by side; arrows keep the first or take the second</source>
        <translation>İkinci inceleyenin ayrıldığı yerleri yan yana göster; oklarla ilki kalır ya da ikincisi alınır</translation>
    </message>
    <message>
        <source>Slower</source>
        <translation>Yavaşlat</translation>
    </message>
    <message>
        <source>Sound page</source>
        <translation>Ses sayfası</translation>
    </message>
    <message>
        <source>Spectrogram alone</source>
        <translation>Yalnız spektrogram</translation>
    </message>
    <message>
        <source>Spectrogram, level and motion large</source>
        <translation>Büyük spektrogram, düzey ve hareket</translation>
    </message>
    <message>
        <source>Spectrum of the selection</source>
        <translation>Seçimin spektrumu</translation>
    </message>
    <message>
        <source>Spread frequencies by octaves, evenly, or as the ear hears them</source>
        <translation>Frekansları oktavlarla, eşit aralıklarla ya da kulağın duyduğu gibi dağıtır</translation>
    </message>
    <message>
        <source>Start page</source>
        <translation>Başlangıç sayfası</translation>
    </message>
    <message>
        <source>Sun, light or dark</source>
        <translation>Güneş, açık ya da koyu</translation>
    </message>
    <message>
        <source>Switch the language</source>
        <translation>Dili değiştirir</translation>
    </message>
    <message>
        <source>Take the last change back; while recording, the last marker</source>
        <translation>Son değişikliği geri alır; kayıt sırasında son işareti</translation>
    </message>
    <message>
        <source>Take the pipe's line from a map: GeoJSON, Shapefile, GeoPackage, KML, GPX, DXF or CSV</source>
        <translation>Borunun çizgisini haritadan al: GeoJSON, Shapefile, GeoPackage, KML, GPX, DXF ya da CSV</translation>
    </message>
    <message>
        <source>Take the second opinions from a colleague's copy of this survey</source>
        <translation>İkinci görüşleri, bu ölçümün iş arkadaşınızdaki kopyasından al</translation>
    </message>
    <message>
        <source>Take the verdict away and stay here</source>
        <translation>Kararı kaldırır ve burada kalır</translation>
    </message>
    <message>
        <source>Tell loud sounds apart</source>
        <translation>Yüksek sesleri ayırt et</translation>
    </message>
    <message>
        <source>The manual's page for what is in front; it needs no network</source>
        <translation>Öndeki sayfaya ait kılavuz sayfası; internet gerekmez</translation>
    </message>
    <message>
        <source>Tie point here</source>
        <translation>Buraya bağlama noktası</translation>
    </message>
    <message>
        <source>Türkçe / English</source>
        <translation>Türkçe / English</translation>
    </message>
    <message>
        <source>Undo</source>
        <translation>Geri al</translation>
    </message>
    <message>
        <source>Unsure</source>
        <translation>Kararsız</translation>
    </message>
    <message>
        <source>Use the whole screen without menus and steps; Escape goes back</source>
        <translation>Menüler ve adımlar olmadan bütün ekranı kullanır; Esc geri döner</translation>
    </message>
    <message>
        <source>What is missing</source>
        <translation>Neler eksik</translation>
    </message>
    <message>
        <source>What will be written, and where</source>
        <translation>Ne yazılacak ve nereye</translation>
    </message>
    <message>
        <source>Which band is heard</source>
        <translation>Hangi bant duyulsun</translation>
    </message>
    <message>
        <source>While it plays, turn pages, keep the cursor in the middle, or leave the view as it is</source>
        <translation>Çalarken sayfa çevirir, imleci ortada tutar ya da görünümü olduğu gibi bırakır</translation>
    </message>
    <message>
        <source>Why a leak</source>
        <translation>Neden kaçak</translation>
    </message>
    <message>
        <source>With the plan in front, show what lies to the north</source>
        <translation>Plan öndeyken kuzeyde ne varsa onu gösterir</translation>
    </message>
    <message>
        <source>With the plan in front, show what lies to the south</source>
        <translation>Plan öndeyken güneyde ne varsa onu gösterir</translation>
    </message>
    <message>
        <source>Write a note; it is saved as you type. Enter ends it</source>
        <translation>Not yazın; yazdıkça kaydedilir. Enter bitirir</translation>
    </message>
    <message>
        <source>Write the PDF, the tables and the map files that are chosen on the report page</source>
        <translation>PDF'i, tabloları ve rapor sayfasında seçilen harita dosyalarını yazar</translation>
    </message>
    <message>
        <source>Write the log and version numbers into a zip file for support; no survey data</source>
        <translation>Destek için günlüğü ve sürüm numaralarını bir zip dosyasına yazar; ölçüm verisi içermez</translation>
    </message>
    <message>
        <source>Zoom in</source>
        <translation>Yakınlaştır</translation>
    </message>
    <message>
        <source>Zoom in up and down</source>
        <translation>Dikeyde yakınlaştır</translation>
    </message>
    <message>
        <source>Zoom out</source>
        <translation>Uzaklaştır</translation>
    </message>
    <message>
        <source>Zoom out up and down</source>
        <translation>Dikeyde uzaklaştır</translation>
    </message>
</context>
<context>
    <name>AllanPlot</name>
    <message>
        <source>Noise of the sensors</source>
        <translation>Algılayıcıların gürültüsü</translation>
    </message>
</context>
<context>
    <name>Application</name>
    <message>
        <source>Go on</source>
        <translation>Devam et</translation>
    </message>
    <message>
        <source>Leakline has stumbled over a fault of its own. Every verdict and note is on disk. ({what})</source>
        <translation>Leakline kendi hatasına takıldı. Bütün kararlar ve notlar diskte. ({what})</translation>
    </message>
    <message>
        <source>Loading</source>
        <translation>Yükleniyor</translation>
    </message>
    <message>
        <source>Save diagnostics…</source>
        <translation>Tanılama dosyası kaydet…</translation>
    </message>
</context>
<context>
    <name>AttitudeBall</name>
    <message>
        <source>Attitude of the device</source>
        <translation>Cihazın duruşu</translation>
    </message>
</context>
<context>
    <name>BandMapView</name>
    <message>
        <source>Map of the bands</source>
        <translation>Bant haritası</translation>
    </message>
</context>
<context>
    <name>BandPanel</name>
    <message>
        <source>Chosen by hand: {low} to {high}.</source>
        <translation>Elle seçildi: {low}–{high}.</translation>
    </message>
    <message>
        <source>How to ask</source>
        <translation>Nasıl sorulacağı</translation>
    </message>
    <message>
        <source>Measure the selection</source>
        <translation>Seçimi ölç</translation>
    </message>
    <message>
        <source>Take as the leak band</source>
        <translation>Kaçak bandı yap</translation>
    </message>
    <message>
        <source>{low} to {high}: the sound is measured again in this band</source>
        <translation>{low}–{high}: ses bu bantta yeniden ölçülür</translation>
    </message>
</context>
<context>
    <name>BatchReject</name>
    <message>
        <source> and {count} more</source>
        <translation> ve {count} aday daha</translation>
    </message>
    <message>
        <source>Close</source>
        <translation>Kapat</translation>
    </message>
    <message>
        <source>Decided ones and marks made by hand stay as they are. One undo takes it all back.</source>
        <translation>Kararı verilmiş olanlar ve elle konan işaretler olduğu gibi kalır. Tek bir geri alma hepsini eski hâline getirir.</translation>
    </message>
    <message>
        <source>Reject below a score</source>
        <translation>Puanı düşük olanları reddet</translation>
    </message>
    <message>
        <source>Reject what is undecided with a score below</source>
        <translation>Karar bekleyenlerden şu puanın altındakileri reddet:</translation>
    </message>
    <message>
        <source>Reject {count}</source>
        <translation>Reddet: {count}</translation>
    </message>
    <message>
        <source>Score</source>
        <translation>Puan</translation>
    </message>
    <message>
        <source>{count} of {all} undecided candidates in the list are below {score}.</source>
        <translation>Listede karar bekleyen {all} adaydan {score} altında olan: {count}.</translation>
    </message>
</context>
<context>
    <name>CandidateModel</name>
    <message>
        <source>Chainage from the launch</source>
        <translation>Bırakma noktasından hat metresi</translation>
    </message>
    <message>
        <source>Class</source>
        <translation>Sınıf</translation>
    </message>
    <message>
        <source>L: found by the machine, M: marked by hand</source>
        <translation>L: programın bulduğu, M: elle işaretlenen</translation>
    </message>
    <message>
        <source>Level above its surroundings</source>
        <translation>Çevresine göre düzey farkı</translation>
    </message>
    <message>
        <source>No.</source>
        <translation>No.</translation>
    </message>
    <message>
        <source>Note</source>
        <translation>Not</translation>
    </message>
    <message>
        <source>Probability that it is a leak</source>
        <translation>Kaçak olma olasılığı</translation>
    </message>
    <message>
        <source>Score</source>
        <translation>Puan</translation>
    </message>
    <message>
        <source>The true place is within this with 95 % probability</source>
        <translation>Gerçek yer %95 olasılıkla bu aralıktadır</translation>
    </message>
    <message>
        <source>Verdict</source>
        <translation>Karar</translation>
    </message>
    <message>
        <source>What it is taken for</source>
        <translation>Neye benzediği</translation>
    </message>
    <message>
        <source>What you decided</source>
        <translation>Sizin kararınız</translation>
    </message>
    <message>
        <source>Your note</source>
        <translation>Sizin notunuz</translation>
    </message>
    <message>
        <source>dB</source>
        <translation>dB</translation>
    </message>
</context>
<context>
    <name>CandidateTable</name>
    <message>
        <source>Leak candidates</source>
        <translation>Kaçak adayları</translation>
    </message>
    <message>
        <source>Leaks have not been looked for yet: process the recording first.</source>
        <translation>Kaçaklar henüz aranmadı: önce kaydı işleyin.</translation>
    </message>
    <message>
        <source>No candidate fits the filter. Choose All above.</source>
        <translation>Süzgece uyan aday yok. Yukarıdan Hepsi seçeneğini seçin.</translation>
    </message>
    <message>
        <source>No leak candidates were found. M marks one by hand at the cursor.</source>
        <translation>Kaçak adayı bulunmadı. M tuşu imlecin yerine elle işaret koyar.</translation>
    </message>
    <message>
        <source>Old places: place the leaks anew</source>
        <translation>Eski yerler: yeniden yerleştir</translation>
    </message>
    <message>
        <source>Tie points were changed: these places are of the path before.</source>
        <translation>Bağlama noktaları değişti: bu yerler önceki yola göredir.</translation>
    </message>
</context>
<context>
    <name>ChannelPanel</name>
    <message>
        <source>Channel</source>
        <translation>Kanal</translation>
    </message>
    <message>
        <source>Figures of the filter</source>
        <translation>Süzgecin bulduğu değerler</translation>
    </message>
    <message>
        <source>Filter</source>
        <translation>Süzgeç</translation>
    </message>
    <message>
        <source>Settings</source>
        <translation>Ayarlar</translation>
    </message>
</context>
<context>
    <name>ChannelView</name>
    <message>
        <source>Channel, raw and filtered</source>
        <translation>Kanal, ham ve süzülmüş</translation>
    </message>
    <message>
        <source>Nothing to show here: choose another channel</source>
        <translation>Burada gösterilecek bir şey yok: başka bir kanal seçin</translation>
    </message>
    <message>
        <source>Reading …</source>
        <translation>Okunuyor …</translation>
    </message>
</context>
<context>
    <name>CleaningControl</name>
    <message>
        <source>Learning the noise of rolling</source>
        <translation>Yuvarlanma gürültüsü öğreniliyor</translation>
    </message>
    <message>
        <source>rolling noise {change} dB, {turns} turns/s</source>
        <translation>yuvarlanma gürültüsü {change} dB, {turns} tur/sn</translation>
    </message>
    <message>
        <source>the picture is cleaned where less than {seconds} s are shown</source>
        <translation>görüntü, {seconds} saniyeden azı gösterildiğinde temizlenir</translation>
    </message>
    <message>
        <source>{count} bumps ducked, {felt} of them felt</source>
        <translation>{count} darbe kısıldı, {felt} tanesini ivmeölçer de hissetti</translation>
    </message>
</context>
<context>
    <name>ClockBox</name>
    <message>
        <source>B began later by (ms)</source>
        <translation>B şu kadar geç başladı (ms)</translation>
    </message>
    <message>
        <source>B runs fast by (ppm)</source>
        <translation>B şu kadar hızlı (ppm)</translation>
    </message>
    <message>
        <source>Both were knocked together</source>
        <translation>İkisine birlikte vuruldu</translation>
    </message>
    <message>
        <source>By taps beyond both ends</source>
        <translation>İki ucun ötesindeki vuruşlarla</translation>
    </message>
    <message>
        <source>Clocks</source>
        <translation>Saatler</translation>
    </message>
    <message>
        <source>Find the knocks in the stretch</source>
        <translation>Seçili aralıktaki vuruşları bul</translation>
    </message>
    <message>
        <source>Hold both recorders in one hand, knock five times, irregularly; choose that stretch and press here</source>
        <translation>İki kaydediciyi bir elde tutup düzensiz aralıklarla beş kez vurun; o aralığı seçip buraya basın</translation>
    </message>
    <message>
        <source>How much faster B's clock runs; what remains is found from the sound itself</source>
        <translation>B saatinin ne kadar hızlı gittiği; kalanı sesin kendisinden bulunur</translation>
    </message>
    <message>
        <source>How the clocks relate</source>
        <translation>Saatlerin ilişkisi</translation>
    </message>
    <message>
        <source>One clock: one recorder, or radio or GPS time</source>
        <translation>Tek saat: tek kaydedici ya da telsiz/GPS saati</translation>
    </message>
    <message>
        <source>The offset is known</source>
        <translation>Saat farkı biliniyor</translation>
    </message>
    <message>
        <source>Unknown: delay only, no place</source>
        <translation>Bilinmiyor: yalnız gecikme, yer yok</translation>
    </message>
    <message>
        <source>±</source>
        <translation>±</translation>
    </message>
</context>
<context>
    <name>ClockPanel</name>
    <message>
        <source>No blow was found that both felt. Next time knock five times at both ends.</source>
        <translation>İkisinin de duyduğu bir vuruş bulunamadı. Bir dahaki sefere iki uçta beşer kez vurun.</translation>
    </message>
</context>
<context>
    <name>ClockView</name>
    <message>
        <source>Blows: felt above, heard below</source>
        <translation>Darbeler: üstte hareket, altta ses</translation>
    </message>
    <message>
        <source>How far the sound comes after the motion: one peak fits</source>
        <translation>Sesin hareketten ne kadar sonra geldiği: tek tepe uyumdur</translation>
    </message>
    <message>
        <source>How the clocks of sound and motion fit</source>
        <translation>Ses ve hareket saatlerinin birbirine uyumu</translation>
    </message>
    <message>
        <source>Left over along the run, ±{ms} ms (shaded: 95 %)</source>
        <translation>Kayıt boyunca kalan, ±{ms} ms (gölge: %95)</translation>
    </message>
    <message>
        <source>{seconds} s</source>
        <translation>{seconds} s</translation>
    </message>
</context>
<context>
    <name>CoherencePlot</name>
    <message>
        <source>Coherence and band</source>
        <translation>Uyum ve bant</translation>
    </message>
    <message>
        <source>Drag the band or its edges. By key: left and right move it, up and down widen it.</source>
        <translation>Bandı ya da kenarlarını sürükleyin. Tuşlarla: sol ve sağ kaydırır, yukarı ve aşağı genişletip daraltır.</translation>
    </message>
    <message>
        <source>Here stands at which frequencies both sensors hear the same.</source>
        <translation>İki algılayıcının hangi frekanslarda aynı sesi duyduğu burada görünür.</translation>
    </message>
    <message>
        <source>chance (99 %)</source>
        <translation>rastlantı (%99)</translation>
    </message>
    <message>
        <source>coherence</source>
        <translation>uyum</translation>
    </message>
    <message>
        <source>frequency (Hz)</source>
        <translation>frekans (Hz)</translation>
    </message>
    <message>
        <source>level A</source>
        <translation>A düzeyi</translation>
    </message>
    <message>
        <source>level B</source>
        <translation>B düzeyi</translation>
    </message>
    <message>
        <source>{hertz} Hz · coherence {value} · A {a} dB · B {b} dB</source>
        <translation>{hertz} Hz · uyum {value} · A {a} dB · B {b} dB</translation>
    </message>
</context>
<context>
    <name>ColumnMappingTable</name>
    <message>
        <source>Column</source>
        <translation>Sütun</translation>
    </message>
    <message>
        <source>First rows</source>
        <translation>İlk satırlar</translation>
    </message>
    <message>
        <source>Meaning</source>
        <translation>Anlamı</translation>
    </message>
    <message>
        <source>Meaning of the columns</source>
        <translation>Sütunların anlamı</translation>
    </message>
    <message>
        <source>Samples a second, if there is no time column</source>
        <translation>Zaman sütunu yoksa saniyedeki örnek sayısı</translation>
    </message>
    <message>
        <source>Still missing: {names}</source>
        <translation>Hâlâ eksik: {names}</translation>
    </message>
    <message>
        <source>Unit</source>
        <translation>Birim</translation>
    </message>
    <message>
        <source>find out</source>
        <translation>kendin bul</translation>
    </message>
    <message>
        <source>not used</source>
        <translation>kullanılmıyor</translation>
    </message>
</context>
<context>
    <name>Columns</name>
    <message>
        <source>accelerometer x</source>
        <translation>ivmeölçer x</translation>
    </message>
    <message>
        <source>accelerometer y</source>
        <translation>ivmeölçer y</translation>
    </message>
    <message>
        <source>accelerometer z</source>
        <translation>ivmeölçer z</translation>
    </message>
    <message>
        <source>gyroscope x</source>
        <translation>jiroskop x</translation>
    </message>
    <message>
        <source>gyroscope y</source>
        <translation>jiroskop y</translation>
    </message>
    <message>
        <source>gyroscope z</source>
        <translation>jiroskop z</translation>
    </message>
    <message>
        <source>magnetometer x</source>
        <translation>manyetometre x</translation>
    </message>
    <message>
        <source>magnetometer y</source>
        <translation>manyetometre y</translation>
    </message>
    <message>
        <source>magnetometer z</source>
        <translation>manyetometre z</translation>
    </message>
    <message>
        <source>pressure</source>
        <translation>basınç</translation>
    </message>
    <message>
        <source>quaternion w</source>
        <translation>dördey w</translation>
    </message>
    <message>
        <source>quaternion x</source>
        <translation>dördey x</translation>
    </message>
    <message>
        <source>quaternion y</source>
        <translation>dördey y</translation>
    </message>
    <message>
        <source>quaternion z</source>
        <translation>dördey z</translation>
    </message>
    <message>
        <source>sample number</source>
        <translation>örnek numarası</translation>
    </message>
    <message>
        <source>temperature</source>
        <translation>sıcaklık</translation>
    </message>
    <message>
        <source>time</source>
        <translation>zaman</translation>
    </message>
</context>
<context>
    <name>CompanyForm</name>
    <message>
        <source>Address</source>
        <translation>Adres</translation>
    </message>
    <message>
        <source>Choose a logo…</source>
        <translation>Logo seç…</translation>
    </message>
    <message>
        <source>Company</source>
        <translation>Firma</translation>
    </message>
    <message>
        <source>Contact</source>
        <translation>İletişim</translation>
    </message>
    <message>
        <source>Foot of every page</source>
        <translation>Sayfa altı yazısı</translation>
    </message>
    <message>
        <source>Licence or project number</source>
        <translation>Lisans ya da proje no</translation>
    </message>
    <message>
        <source>Logo</source>
        <translation>Logo</translation>
    </message>
    <message>
        <source>More lines of the cover</source>
        <translation>Kapağa ek satırlar</translation>
    </message>
    <message>
        <source>No logo</source>
        <translation>Logo olmasın</translation>
    </message>
    <message>
        <source>Your company on the report</source>
        <translation>Rapordaki firma bilgileri</translation>
    </message>
    <message>
        <source>one a line, for example:  Contract: 2026/17</source>
        <translation>her satıra bir tane, örneğin:  Sözleşme: 2026/17</translation>
    </message>
    <message>
        <source>telephone, e-mail</source>
        <translation>telefon, e-posta</translation>
    </message>
</context>
<context>
    <name>ComparisonControl</name>
    <message>
        <source>'End off' is how far it ends from '{name}'.</source>
        <translation>'Son farkı', yolun '{name}' noktasından ne kadar uzakta bittiğidir.</translation>
    </message>
    <message>
        <source>'Length off' is measured against the pipe's length of {length}.</source>
        <translation>'Uzunluk farkı', borunun {length} uzunluğuna göre ölçülür.</translation>
    </message>
    <message>
        <source>'Length off' is measured at '{name}'; nothing tells where the end lies.</source>
        <translation>'Uzunluk farkı' '{name}' noktasında ölçülür; sonun nerede olduğunu söyleyen bir şey yok.</translation>
    </message>
    <message>
        <source>No first heading is known, so each path was turned to fit first.</source>
        <translation>İlk yön bilinmediği için her yol önce uyacak biçimde döndürüldü.</translation>
    </message>
    <message>
        <source>No tie point or length is known, so nothing tells which is right: compare the shapes.</source>
        <translation>Bağlama noktası ya da uzunluk bilinmiyor; hangisinin doğru olduğunu söyleyen bir şey yok: biçimleri karşılaştırın.</translation>
    </message>
    <message>
        <source>Trying the methods</source>
        <translation>Yöntemler deneniyor</translation>
    </message>
    <message>
        <source>automatic</source>
        <translation>otomatik</translation>
    </message>
    <message>
        <source>orientation method</source>
        <translation>yönelim yöntemi</translation>
    </message>
</context>
<context>
    <name>CorrelationPlot</name>
    <message>
        <source>Choose the recordings of sensor A and sensor B, and say what pipe lies between them.</source>
        <translation>A ve B algılayıcılarının kayıtlarını seçin ve aralarındaki boruyu girin.</translation>
    </message>
    <message>
        <source>Click a peak to choose it. Wheel zooms, drag moves, F shows all.</source>
        <translation>Bir tepeyi seçmek için tıklayın. Tekerlek yakınlaştırır, sürükleme kaydırır, F tümünü gösterir.</translation>
    </message>
    <message>
        <source>Correlation along the pipe</source>
        <translation>Boru boyunca korelasyon</translation>
    </message>
    <message>
        <source>chance (99 %)</source>
        <translation>rastlantı (%99)</translation>
    </message>
    <message>
        <source>correlation</source>
        <translation>korelasyon</translation>
    </message>
    <message>
        <source>delay of B (ms)</source>
        <translation>B'nin gecikmesi (ms)</translation>
    </message>
    <message>
        <source>envelope</source>
        <translation>zarf</translation>
    </message>
    <message>
        <source>metres from sensor A</source>
        <translation>A algılayıcısından uzaklık (m)</translation>
    </message>
    <message>
        <source>taken out</source>
        <translation>bastırıldı</translation>
    </message>
    <message>
        <source>{metres} m from A · {delay} ms · correlation {value}</source>
        <translation>A'dan {metres} m · {delay} ms · korelasyon {value}</translation>
    </message>
</context>
<context>
    <name>CorrelatorControl</name>
    <message>
        <source>Comparing…</source>
        <translation>Karşılaştırılıyor…</translation>
    </message>
    <message>
        <source>Correlator</source>
        <translation>Korelatör</translation>
    </message>
    <message>
        <source>No result</source>
        <translation>Sonuç yok</translation>
    </message>
    <message>
        <source>Nothing can be played: {reason}</source>
        <translation>Ses çalınamıyor: {reason}</translation>
    </message>
    <message>
        <source>Stopped</source>
        <translation>Durduruldu</translation>
    </message>
</context>
<context>
    <name>CorrelatorFiles</name>
    <message>
        <source>All files</source>
        <translation>Tüm dosyalar</translation>
    </message>
    <message>
        <source>Correlation</source>
        <translation>Korelasyon</translation>
    </message>
    <message>
        <source>Export</source>
        <translation>Dışa aktar</translation>
    </message>
    <message>
        <source>Open a correlation</source>
        <translation>Korelasyon aç</translation>
    </message>
    <message>
        <source>Recording of sensor A</source>
        <translation>A algılayıcısının kaydı</translation>
    </message>
    <message>
        <source>Recording of sensor B</source>
        <translation>B algılayıcısının kaydı</translation>
    </message>
    <message>
        <source>Save the correlation</source>
        <translation>Korelasyonu kaydet</translation>
    </message>
    <message>
        <source>Sound</source>
        <translation>Ses</translation>
    </message>
    <message>
        <source>Written: {name}</source>
        <translation>Yazıldı: {name}</translation>
    </message>
</context>
<context>
    <name>CorrelatorMeasuring</name>
    <message>
        <source>Clock offset {offset} ms.</source>
        <translation>Saat farkı {offset} ms.</translation>
    </message>
    <message>
        <source>Enter at which metre from A you tapped.</source>
        <translation>A'dan kaç metrede vurduğunuzu girin.</translation>
    </message>
    <message>
        <source>Looking for the knocks</source>
        <translation>Vuruşlar aranıyor</translation>
    </message>
    <message>
        <source>{speed} ± {sigma} m/s, taken over.</source>
        <translation>{speed} ± {sigma} m/s, boruya yazıldı.</translation>
    </message>
</context>
<context>
    <name>CorrelatorPage</name>
    <message>
        <source>?</source>
        <translation>?</translation>
    </message>
    <message>
        <source>A in the left ear, B in the right</source>
        <translation>A sol kulakta, B sağ kulakta</translation>
    </message>
    <message>
        <source>At which frequency the speeds of the sections hold; empty: not known</source>
        <translation>Kesimlerdeki hızların geçerli olduğu frekans; boş: bilinmiyor</translation>
    </message>
    <message>
        <source>Auto band</source>
        <translation>Otomatik bant</translation>
    </message>
    <message>
        <source>Band (Hz)</source>
        <translation>Bant (Hz)</translation>
    </message>
    <message>
        <source>Coherence</source>
        <translation>Uyum</translation>
    </message>
    <message>
        <source>Dispersion</source>
        <translation>Dispersiyon</translation>
    </message>
    <message>
        <source>Divide resonances</source>
        <translation>Rezonansları böl</translation>
    </message>
    <message>
        <source>Exchange the recordings of A and B</source>
        <translation>A ve B kayıtlarını değiş tokuş et</translation>
    </message>
    <message>
        <source>Export…</source>
        <translation>Dışa aktar…</translation>
    </message>
    <message>
        <source>Hear A</source>
        <translation>A'yı dinle</translation>
    </message>
    <message>
        <source>Hear B</source>
        <translation>B'yi dinle</translation>
    </message>
    <message>
        <source>Hear band only</source>
        <translation>Yalnız bandı dinle</translation>
    </message>
    <message>
        <source>Hear both</source>
        <translation>İkisini dinle</translation>
    </message>
    <message>
        <source>How much each frequency counts</source>
        <translation>Her frekansın ne kadar sayıldığı</translation>
    </message>
    <message>
        <source>Leave out narrow tones: mains hum, pumps</source>
        <translation>Dar tonları dışarıda bırak: şebeke uğultusu, pompalar</translation>
    </message>
    <message>
        <source>Let the speed grow with frequency as the phase shows it</source>
        <translation>Hız, fazın gösterdiği kadar frekansla artsın</translation>
    </message>
    <message>
        <source>Listen to sensor A</source>
        <translation>A algılayıcısını dinle</translation>
    </message>
    <message>
        <source>Listen to sensor B</source>
        <translation>B algılayıcısını dinle</translation>
    </message>
    <message>
        <source>Method</source>
        <translation>Yöntem</translation>
    </message>
    <message>
        <source>No hum</source>
        <translation>Uğultusuz</translation>
    </message>
    <message>
        <source>Open a saved correlation</source>
        <translation>Kaydedilmiş bir korelasyonu aç</translation>
    </message>
    <message>
        <source>Open…</source>
        <translation>Aç…</translation>
    </message>
    <message>
        <source>Over time</source>
        <translation>Zaman içinde</translation>
    </message>
    <message>
        <source>Phase</source>
        <translation>Faz</translation>
    </message>
    <message>
        <source>Pipe from A to B</source>
        <translation>A'dan B'ye boru</translation>
    </message>
    <message>
        <source>Put back</source>
        <translation>Geri koy</translation>
    </message>
    <message>
        <source>Put back the peak that was taken out last</source>
        <translation>Son bastırılan tepeyi geri al</translation>
    </message>
    <message>
        <source>Remove the chosen peak and show the next</source>
        <translation>Seçili tepeyi kaldır ve sonrakini göster</translation>
    </message>
    <message>
        <source>Save recordings, pipe and choices as a small file</source>
        <translation>Kayıtları, boruyu ve seçimleri küçük bir dosyaya kaydet</translation>
    </message>
    <message>
        <source>Save…</source>
        <translation>Kaydet…</translation>
    </message>
    <message>
        <source>Sensor A</source>
        <translation>A algılayıcısı</translation>
    </message>
    <message>
        <source>Sensor B</source>
        <translation>B algılayıcısı</translation>
    </message>
    <message>
        <source>Swap</source>
        <translation>A ⇄ B</translation>
    </message>
    <message>
        <source>Take out the ringing of one sensor or its fitting</source>
        <translation>Bir algılayıcının ya da bağlantısının çınlamasını gider</translation>
    </message>
    <message>
        <source>Take peak out</source>
        <translation>Tepeyi bastır</translation>
    </message>
    <message>
        <source>Use the frequencies in which both hear the same</source>
        <translation>İkisinin aynı sesi duyduğu frekansları kullan</translation>
    </message>
    <message>
        <source>Weighting</source>
        <translation>Ağırlık</translation>
    </message>
    <message>
        <source>Write the page as PDF, the curve as CSV, all as JSON</source>
        <translation>Sayfayı PDF, eğriyi CSV, tümünü JSON olarak yaz</translation>
    </message>
    <message>
        <source>speeds hold at (Hz)</source>
        <translation>hızların frekansı (Hz)</translation>
    </message>
    <message>
        <source>what it is: draw-off, echo …</source>
        <translation>ne olduğu: su kullanımı, yankı …</translation>
    </message>
</context>
<context>
    <name>CrsField</name>
    <message>
        <source>Change…</source>
        <translation>Değiştir…</translation>
    </message>
    <message>
        <source>Coordinate systems</source>
        <translation>Koordinat sistemleri</translation>
    </message>
    <message>
        <source>Not known: choose it below.</source>
        <translation>Bilinmiyor: aşağıdan seçin.</translation>
    </message>
    <message>
        <source>Search a coordinate system</source>
        <translation>Koordinat sistemi ara</translation>
    </message>
    <message>
        <source>Search: code, name or country</source>
        <translation>Ara: kod, ad ya da ülke</translation>
    </message>
    <message>
        <source>{length} from the launch</source>
        <translation>bırakma noktasından {length}</translation>
    </message>
</context>
<context>
    <name>DataPage</name>
    <message>
        <source>Findings</source>
        <translation>Bulgular</translation>
    </message>
    <message>
        <source>Form</source>
        <translation>Form</translation>
    </message>
    <message>
        <source>Process</source>
        <translation>İşle</translation>
    </message>
    <message>
        <source>Tie points</source>
        <translation>Bağlama noktaları</translation>
    </message>
    <message>
        <source>Tie points ({count})</source>
        <translation>Bağlama noktaları ({count})</translation>
    </message>
</context>
<context>
    <name>DecisionPanel</name>
    <message>
        <source>Class</source>
        <translation>Sınıf</translation>
    </message>
    <message>
        <source>Class (C); {sign} is what the machine takes it for</source>
        <translation>Sınıf (C); {sign}: programın tahmini</translation>
    </message>
    <message>
        <source>Clear</source>
        <translation>Temizle</translation>
    </message>
    <message>
        <source>Confirm</source>
        <translation>Onayla</translation>
    </message>
    <message>
        <source>No candidate selected</source>
        <translation>Aday seçilmedi</translation>
    </message>
    <message>
        <source>Note</source>
        <translation>Not</translation>
    </message>
    <message>
        <source>Note (Enter)</source>
        <translation>Not (Enter)</translation>
    </message>
    <message>
        <source>Notes used in this survey (Shift+Enter)</source>
        <translation>Bu ölçümde yazılmış notlar (Shift+Enter)</translation>
    </message>
    <message>
        <source>Reject</source>
        <translation>Reddet</translation>
    </message>
    <message>
        <source>Unsure</source>
        <translation>Kararsız</translation>
    </message>
</context>
<context>
    <name>DeviceForm</name>
    <message>
        <source>Address of the IMU</source>
        <translation>IMU adresi</translation>
    </message>
    <message>
        <source>Baud rate</source>
        <translation>Baud hızı</translation>
    </message>
    <message>
        <source>CSV lines</source>
        <translation>CSV satırları</translation>
    </message>
    <message>
        <source>Channels</source>
        <translation>Kanallar</translation>
    </message>
    <message>
        <source>Connection of the IMU</source>
        <translation>IMU bağlantısı</translation>
    </message>
    <message>
        <source>IMU</source>
        <translation>IMU</translation>
    </message>
    <message>
        <source>Look for devices that were plugged in since</source>
        <translation>Sonradan takılan cihazları arar</translation>
    </message>
    <message>
        <source>Port</source>
        <translation>Port</translation>
    </message>
    <message>
        <source>Protocol of the IMU</source>
        <translation>IMU protokolü</translation>
    </message>
    <message>
        <source>Sample rate</source>
        <translation>Örnekleme hızı</translation>
    </message>
    <message>
        <source>Search again</source>
        <translation>Yeniden ara</translation>
    </message>
    <message>
        <source>Serial port</source>
        <translation>Seri port</translation>
    </message>
    <message>
        <source>Sound</source>
        <translation>Ses</translation>
    </message>
    <message>
        <source>Sound device</source>
        <translation>Ses cihazı</translation>
    </message>
    <message>
        <source>any sender</source>
        <translation>herhangi bir gönderen</translation>
    </message>
    <message>
        <source>binary frames</source>
        <translation>ikili çerçeveler</translation>
    </message>
    <message>
        <source>channels: {count}</source>
        <translation>kanal: {count}</translation>
    </message>
    <message>
        <source>found by itself</source>
        <translation>kendiliğinden bulunur</translation>
    </message>
    <message>
        <source>network TCP</source>
        <translation>ağ, TCP</translation>
    </message>
    <message>
        <source>network UDP</source>
        <translation>ağ, UDP</translation>
    </message>
    <message>
        <source>none</source>
        <translation>yok</translation>
    </message>
    <message>
        <source>printed lines</source>
        <translation>yazdırılan satırlar</translation>
    </message>
    <message>
        <source>protocol: auto</source>
        <translation>protokol: otomatik</translation>
    </message>
    <message>
        <source>rate: auto</source>
        <translation>hız: otomatik</translation>
    </message>
    <message>
        <source>serial (USB)</source>
        <translation>seri (USB)</translation>
    </message>
    <message>
        <source>the system's input</source>
        <translation>sistemin girişi</translation>
    </message>
    <message>
        <source>{name} (not there now)</source>
        <translation>{name} (şu an takılı değil)</translation>
    </message>
</context>
<context>
    <name>DifferencesPanel</name>
    <message>
        <source>All differences</source>
        <translation>Tüm farklar</translation>
    </message>
    <message>
        <source>Differences between the reviewers</source>
        <translation>İnceleyenler arasındaki farklar</translation>
    </message>
    <message>
        <source>Enter  Open</source>
        <translation>Enter  Aç</translation>
    </message>
    <message>
        <source>First</source>
        <translation>İlk</translation>
    </message>
    <message>
        <source>First: {name}</source>
        <translation>İlk: {name}</translation>
    </message>
    <message>
        <source>Leak</source>
        <translation>Kaçak</translation>
    </message>
    <message>
        <source>Leaks page</source>
        <translation>Kaçaklar sayfası</translation>
    </message>
    <message>
        <source>Not settled</source>
        <translation>Sonuca bağlanmamış</translation>
    </message>
    <message>
        <source>Opinions of a colleague…</source>
        <translation>İş arkadaşının görüşleri…</translation>
    </message>
    <message>
        <source>Other verdict</source>
        <translation>Kararı farklı</translation>
    </message>
    <message>
        <source>Place</source>
        <translation>Yer</translation>
    </message>
    <message>
        <source>Second</source>
        <translation>İkinci</translation>
    </message>
    <message>
        <source>Second reviewer</source>
        <translation>İkinci inceleyen</translation>
    </message>
    <message>
        <source>Second: {name}</source>
        <translation>İkinci: {name}</translation>
    </message>
    <message>
        <source>Take the second  →</source>
        <translation>İkincisini al  →</translation>
    </message>
    <message>
        <source>Which differences</source>
        <translation>Hangi farklar</translation>
    </message>
    <message>
        <source>←  Keep the first</source>
        <translation>←  İlki kalsın</translation>
    </message>
</context>
<context>
    <name>DigControl</name>
    <message>
        <source>Damaged lines of the history that were left out: {count}</source>
        <translation>Geçmişte okunamadığı için atlanan satır: {count}</translation>
    </message>
    <message>
        <source>No digs are known yet. Each one that is entered here makes the statement better.</source>
        <translation>Henüz bilinen kazı yok. Buraya yazılan her kazı, doğruluk bildirimini iyileştirir.</translation>
    </message>
    <message>
        <source>Process the survey first: what a dig showed belongs to a leak.</source>
        <translation>Önce ölçümü işleyin: kazı sonucu bir kaçağa yazılır.</translation>
    </message>
    <message>
        <source>Save the dig first: a photo belongs to a leak that is on the list.</source>
        <translation>Önce kazıyı kaydedin: fotoğraf, listedeki bir kaçağa aittir.</translation>
    </message>
    <message>
        <source>Saved: {what}</source>
        <translation>Kaydedildi: {what}</translation>
    </message>
    <message>
        <source>Take in history of digs</source>
        <translation>Kazı geçmişini al</translation>
    </message>
    <message>
        <source>Write history of digs</source>
        <translation>Kazı geçmişini yaz</translation>
    </message>
    <message>
        <source>dig at {name}</source>
        <translation>{name} kazısı</translation>
    </message>
    <message>
        <source>intervals as computed</source>
        <translation>aralıklar hesaplandığı gibi</translation>
    </message>
    <message>
        <source>leak found elsewhere</source>
        <translation>başka yerde bulunan kaçak</translation>
    </message>
    <message>
        <source>wider intervals</source>
        <translation>daha geniş aralıklar</translation>
    </message>
</context>
<context>
    <name>DigForm</name>
    <message>
        <source>A day earlier</source>
        <translation>Bir gün önce</translation>
    </message>
    <message>
        <source>A day later</source>
        <translation>Bir gün sonra</translation>
    </message>
    <message>
        <source>Add photo…</source>
        <translation>Fotoğraf ekle…</translation>
    </message>
    <message>
        <source>Beside the path ({unit})</source>
        <translation>Yolun yanında ({unit})</translation>
    </message>
    <message>
        <source>By chainage</source>
        <translation>Hat metresiyle</translation>
    </message>
    <message>
        <source>By coordinates</source>
        <translation>Koordinatla</translation>
    </message>
    <message>
        <source>By tape</source>
        <translation>Şerit metreyle</translation>
    </message>
    <message>
        <source>Cause</source>
        <translation>Neden</translation>
    </message>
    <message>
        <source>Chainage ({unit})</source>
        <translation>Hat metresi ({unit})</translation>
    </message>
    <message>
        <source>Coordinates</source>
        <translation>Koordinatlar</translation>
    </message>
    <message>
        <source>Day of the dig</source>
        <translation>Kazı günü</translation>
    </message>
    <message>
        <source>Depth ({unit})</source>
        <translation>Derinlik ({unit})</translation>
    </message>
    <message>
        <source>Dug by</source>
        <translation>Kazan ekip</translation>
    </message>
    <message>
        <source>Dug by the report of</source>
        <translation>Kazıda kullanılan rapor</translation>
    </message>
    <message>
        <source>Flow ({unit})</source>
        <translation>Debi ({unit})</translation>
    </message>
    <message>
        <source>Found at</source>
        <translation>Bulunduğu yer</translation>
    </message>
    <message>
        <source>Leak</source>
        <translation>Kaçak</translation>
    </message>
    <message>
        <source>Measured to ± ({unit})</source>
        <translation>Ölçüm payı ± ({unit})</translation>
    </message>
    <message>
        <source>Note</source>
        <translation>Not</translation>
    </message>
    <message>
        <source>Nothing</source>
        <translation>Hiçbir şey</translation>
    </message>
    <message>
        <source>Save correction</source>
        <translation>Düzeltmeyi kaydet</translation>
    </message>
    <message>
        <source>Save this dig</source>
        <translation>Kazıyı kaydet</translation>
    </message>
    <message>
        <source>Something else</source>
        <translation>Başka bir şey</translation>
    </message>
    <message>
        <source>Take back</source>
        <translation>Geri çek</translation>
    </message>
    <message>
        <source>as usual</source>
        <translation>her zamanki gibi</translation>
    </message>
    <message>
        <source>away from it ▶</source>
        <translation>ondan uzağa ▶</translation>
    </message>
    <message>
        <source>chainage</source>
        <translation>mesafe</translation>
    </message>
    <message>
        <source>distance</source>
        <translation>uzaklık</translation>
    </message>
    <message>
        <source>latitude longitude, or east north</source>
        <translation>enlem boylam ya da doğu kuzey</translation>
    </message>
    <message>
        <source>not measured</source>
        <translation>ölçülmedi</translation>
    </message>
    <message>
        <source>{unit} from the stated place</source>
        <translation>{unit}, bildirilen yerden</translation>
    </message>
    <message>
        <source>◀ towards the launch</source>
        <translation>◀ bırakmaya doğru</translation>
    </message>
</context>
<context>
    <name>DigLedger</name>
    <message>
        <source>; {damaged} damaged lines left out</source>
        <translation>; okunamayan {damaged} satır atlandı</translation>
    </message>
    <message>
        <source>History of digs</source>
        <translation>Kazı geçmişi</translation>
    </message>
    <message>
        <source>Taking in the history of digs</source>
        <translation>Kazı geçmişi alınıyor</translation>
    </message>
    <message>
        <source>Writing the history of digs</source>
        <translation>Kazı geçmişi yazılıyor</translation>
    </message>
    <message>
        <source>{count} digs of other surveys taken in</source>
        <translation>Başka ölçümlerden {count} kazı alındı</translation>
    </message>
    <message>
        <source>{count} digs written to {file}</source>
        <translation>{count} kazı {file} dosyasına yazıldı</translation>
    </message>
</context>
<context>
    <name>DigList</name>
    <message>
        <source>Digs of this survey</source>
        <translation>Bu ölçümün kazıları</translation>
    </message>
    <message>
        <source>Dug on</source>
        <translation>Kazı günü</translation>
    </message>
    <message>
        <source>Found</source>
        <translation>Bulunan</translation>
    </message>
    <message>
        <source>Interval</source>
        <translation>Aralık</translation>
    </message>
    <message>
        <source>Leak</source>
        <translation>Kaçak</translation>
    </message>
    <message>
        <source>Off by</source>
        <translation>Sapma</translation>
    </message>
    <message>
        <source>Stated</source>
        <translation>Bildirilen</translation>
    </message>
    <message>
        <source>inside</source>
        <translation>içinde</translation>
    </message>
    <message>
        <source>no leak</source>
        <translation>kaçak yok</translation>
    </message>
    <message>
        <source>not stated</source>
        <translation>bildirilmemiş</translation>
    </message>
    <message>
        <source>outside</source>
        <translation>dışında</translation>
    </message>
    <message>
        <source>▶ away from the launch, ◀ towards it</source>
        <translation>▶ bırakmadan uzağa, ◀ bırakmaya doğru</translation>
    </message>
</context>
<context>
    <name>DigPage</name>
    <message>
        <source>Back</source>
        <translation>Geri</translation>
    </message>
    <message>
        <source>Digs</source>
        <translation>Kazılar</translation>
    </message>
    <message>
        <source>Leak found elsewhere…</source>
        <translation>Başka yerde bulunan kaçak…</translation>
    </message>
    <message>
        <source>Take in history…</source>
        <translation>Geçmiş al…</translation>
    </message>
    <message>
        <source>What all digs on this computer say</source>
        <translation>Bu bilgisayardaki bütün kazılara göre</translation>
    </message>
    <message>
        <source>Write history…</source>
        <translation>Geçmişi yaz…</translation>
    </message>
</context>
<context>
    <name>DigWording</name>
    <message>
        <source>A leak that was found where none had been stated. Where was it?</source>
        <translation>Bildirilmemiş bir yerde bulunan kaçak. Neredeydi?</translation>
    </message>
    <message>
        <source>In which direction was it found? Press one of the two arrows.</source>
        <translation>Hangi yönde bulundu? İki oktan birine basın.</translation>
    </message>
    <message>
        <source>No place had been stated in metres: measure by tape, or leave the place empty.</source>
        <translation>Metre olarak bir yer bildirilmemişti: şerit metreyle ölçün ya da yeri boş bırakın.</translation>
    </message>
    <message>
        <source>State all intervals of this report {factor} times as wide</source>
        <translation>Bu rapordaki bütün aralıkları {factor} kat geniş bildir</translation>
    </message>
    <message>
        <source>State the intervals as computed again (now {factor} times as wide)</source>
        <translation>Aralıkları yeniden hesaplandığı gibi bildir (şimdi {factor} kat geniş)</translation>
    </message>
    <message>
        <source>This survey has no path to put coordinates on: measure by tape.</source>
        <translation>Bu ölçümde koordinatın oturtulacağı yol yok: şerit metreyle ölçün.</translation>
    </message>
    <message>
        <source>Type the chainage or the coordinates of the leak.</source>
        <translation>Kaçağın mesafesini ya da koordinatlarını yazın.</translation>
    </message>
    <message>
        <source>What was found? Press Leak, Something else or Nothing.</source>
        <translation>Ne bulundu? Kaçak, Başka bir şey ya da Hiçbir şey düğmesine basın.</translation>
    </message>
    <message>
        <source>corrosion</source>
        <translation>korozyon</translation>
    </message>
    <message>
        <source>crack</source>
        <translation>çatlak</translation>
    </message>
    <message>
        <source>earlier repair</source>
        <translation>eski onarım</translation>
    </message>
    <message>
        <source>found at {place}</source>
        <translation>{place} mesafede bulundu</translation>
    </message>
    <message>
        <source>hole</source>
        <translation>delik</translation>
    </message>
    <message>
        <source>joint</source>
        <translation>boru eki</translation>
    </message>
    <message>
        <source>leak</source>
        <translation>kaçak</translation>
    </message>
    <message>
        <source>no leak where one was stated</source>
        <translation>bildirilen yerde kaçak yok</translation>
    </message>
    <message>
        <source>not measured: it counts as found, not as an error</source>
        <translation>yeri ölçülmedi: bulundu sayılır, sapma hesabına girmez</translation>
    </message>
    <message>
        <source>not stated before: it is marked by hand, confirmed</source>
        <translation>önceden bildirilmemiş: elle işaretlendi ve onaylandı</translation>
    </message>
    <message>
        <source>nothing</source>
        <translation>hiçbir şey</translation>
    </message>
    <message>
        <source>outside the stated interval</source>
        <translation>bildirilen aralığın dışında</translation>
    </message>
    <message>
        <source>run {run}, {day}: {place}</source>
        <translation>{run}. işleme, {day}: {place}</translation>
    </message>
    <message>
        <source>service connection</source>
        <translation>abone bağlantısı</translation>
    </message>
    <message>
        <source>something else</source>
        <translation>başka bir şey</translation>
    </message>
    <message>
        <source>the stated interval holds it</source>
        <translation>bildirilen aralığın içinde</translation>
    </message>
    <message>
        <source>valve</source>
        <translation>vana</translation>
    </message>
    <message>
        <source>{length} away from launch ▶</source>
        <translation>{length} bırakmadan uzağa ▶</translation>
    </message>
    <message>
        <source>{length} beside the path</source>
        <translation>yolun {length} yanında</translation>
    </message>
    <message>
        <source>{name}, stated at {place}</source>
        <translation>{name}, bildirilen yer {place}</translation>
    </message>
    <message>
        <source>{name}: a leak that had not been stated</source>
        <translation>{name}: bildirilmemiş bir kaçak</translation>
    </message>
    <message>
        <source>{name}: the present run has no such place any more</source>
        <translation>{name}: bugünkü işlemede böyle bir yer yok</translation>
    </message>
    <message>
        <source>◀ {length} towards launch</source>
        <translation>◀ {length} bırakmaya doğru</translation>
    </message>
</context>
<context>
    <name>Evidence</name>
    <message>
        <source>95 % between {low} and {high}, passed at {time}.</source>
        <translation>%95 olasılıkla {low} ile {high} arasında; geçiş zamanı {time}.</translation>
    </message>
    <message>
        <source>Leak with {percent} probability; looks like: {kind}.</source>
        <translation>Kaçak olasılığı {percent}; benzediği: {kind}.</translation>
    </message>
    <message>
        <source>Leak {percent} · looks like: {kind}</source>
        <translation>Kaçak {percent} · benzediği: {kind}</translation>
    </message>
    <message>
        <source>Marked by hand.</source>
        <translation>Elle işaretlendi.</translation>
    </message>
    <message>
        <source>{level} dB above its surroundings from {low} to {high}, {width} wide.</source>
        <translation>{low} – {high} arasında çevresinden {level} dB yüksek, {width} boyunca.</translation>
    </message>
</context>
<context>
    <name>EvidenceControl</name>
    <message>
        <source>known leak</source>
        <translation>bilinen kaçak</translation>
    </message>
</context>
<context>
    <name>EvidencePanel</name>
    <message>
        <source>A tap of measured flow: other leaks are sized beside it</source>
        <translation>Debisi ölçülmüş bir musluk: öteki kaçakların büyüklüğü onunla ölçülür</translation>
    </message>
    <message>
        <source>Dot: here. Bar: {count} places elsewhere (half within). + speaks for a leak, − against.</source>
        <translation>Nokta: burası. Kutu: başka {count} yer (yarısı içinde). + kaçaktan yana, − karşı.</translation>
    </message>
    <message>
        <source>Known leak…</source>
        <translation>Bilinen kaçak…</translation>
    </message>
    <message>
        <source>Level over the surroundings; blue: 95 % of them</source>
        <translation>Çevrenin üstündeki düzey; mavi: çevrenin %95'i</translation>
    </message>
    <message>
        <source>Rise and fall along the pipe, with the fit</source>
        <translation>Boru boyunca yükselip alçalma ve uyan eğri</translation>
    </message>
</context>
<context>
    <name>FilesControl</name>
    <message>
        <source>Cancel</source>
        <translation>İptal</translation>
    </message>
    <message>
        <source>Copying the recording</source>
        <translation>Kayıt kopyalanıyor</translation>
    </message>
    <message>
        <source>Demonstration</source>
        <translation>Tanıtım</translation>
    </message>
    <message>
        <source>Form or tie points have changed.</source>
        <translation>Form ya da bağlama noktaları değişti.</translation>
    </message>
    <message>
        <source>Keep as marks</source>
        <translation>İşaret olarak tut</translation>
    </message>
    <message>
        <source>Keep the band</source>
        <translation>Bandı değiştirme</translation>
    </message>
    <message>
        <source>Leave them listed</source>
        <translation>Listede bırak</translation>
    </message>
    <message>
        <source>Look for leaks from {low} to {high}? The sound is gone through again.</source>
        <translation>Kaçaklar {low} – {high} arasında mı aransın? Ses yeniden taranır.</translation>
    </message>
    <message>
        <source>Looking at {name}</source>
        <translation>{name} inceleniyor</translation>
    </message>
    <message>
        <source>Nobody uses it: open anyway</source>
        <translation>Kimse kullanmıyor: yine de aç</translation>
    </message>
    <message>
        <source>Not processed yet: press Process.</source>
        <translation>Henüz işlenmedi: İşle düğmesine basın.</translation>
    </message>
    <message>
        <source>Open read-only</source>
        <translation>Salt okunur aç</translation>
    </message>
    <message>
        <source>Open the device's folder or a survey</source>
        <translation>Cihazın klasörünü ya da bir ölçümü açın</translation>
    </message>
    <message>
        <source>Process</source>
        <translation>İşle</translation>
    </message>
    <message>
        <source>Process again</source>
        <translation>Yeniden işle</translation>
    </message>
    <message>
        <source>Processing</source>
        <translation>İşleniyor</translation>
    </message>
    <message>
        <source>Processing …</source>
        <translation>İşleniyor …</translation>
    </message>
    <message>
        <source>Restore the newest backup</source>
        <translation>En yeni yedeği geri yükle</translation>
    </message>
    <message>
        <source>Something is missing: see the findings and the list of files.</source>
        <translation>Eksik bir şey var: bulgulara ve dosya listesine bakın.</translation>
    </message>
    <message>
        <source>Survey made: {path}</source>
        <translation>Ölçüm oluşturuldu: {path}</translation>
    </message>
    <message>
        <source>The results are up to date.</source>
        <translation>Sonuçlar güncel.</translation>
    </message>
    <message>
        <source>These earlier verdicts found no candidate any more. Nothing is lost; keep them as marks?</source>
        <translation>Daha önceki şu kararlara karşılık gelen aday artık yok. Hiçbir şey kaybolmadı; işaret olarak kalsınlar mı?</translation>
    </message>
    <message>
        <source>This folder was processed before: its survey is opened.</source>
        <translation>Bu klasör daha önce işlenmiş: ölçümü açılıyor.</translation>
    </message>
    <message>
        <source>Verdict without a candidate at {place}: {verdict} {note}</source>
        <translation>Adayı kalmamış karar ({place}): {verdict} {note}</translation>
    </message>
    <message>
        <source>form</source>
        <translation>form</translation>
    </message>
    <message>
        <source>leak band</source>
        <translation>kaçak bandı</translation>
    </message>
    <message>
        <source>route</source>
        <translation>güzergâh</translation>
    </message>
    <message>
        <source>tie points</source>
        <translation>bağlama noktaları</translation>
    </message>
</context>
<context>
    <name>FindingsPanel</name>
    <message>
        <source>Findings</source>
        <translation>Bulgular</translation>
    </message>
    <message>
        <source>Nothing to complain about.</source>
        <translation>Sorun yok.</translation>
    </message>
    <message>
        <source>Path</source>
        <translation>Yol</translation>
    </message>
    <message>
        <source>Sound</source>
        <translation>Ses</translation>
    </message>
    <message>
        <source>{what} not assessed from {start} to {end}: {reason}</source>
        <translation>{what} {start} – {end} arasında değerlendirilmedi: {reason}</translation>
    </message>
</context>
<context>
    <name>FirstSound</name>
    <message>
        <source>A first look at the sound</source>
        <translation>Sese ilk bakış</translation>
    </message>
    <message>
        <source>A first look at the sound: one moment here and there, until it is processed</source>
        <translation>Sese ilk bakış: işlenene kadar yalnızca yer yer alınmış anlar gösteriliyor</translation>
    </message>
    <message>
        <source>Still listening, {percent} %: beyond that it is a first look, one moment here and there</source>
        <translation>Dinleme sürüyor, %{percent}: ötesi ilk bakış, yalnızca yer yer alınmış anlar</translation>
    </message>
</context>
<context>
    <name>GalleryGrid</name>
    <message>
        <source>Gallery of the candidates</source>
        <translation>Adaylar galerisi</translation>
    </message>
</context>
<context>
    <name>GalleryPanel</name>
    <message>
        <source>0  Clear</source>
        <translation>0  Temizle</translation>
    </message>
    <message>
        <source>1  Confirm</source>
        <translation>1  Onayla</translation>
    </message>
    <message>
        <source>2  Reject</source>
        <translation>2  Reddet</translation>
    </message>
    <message>
        <source>3  Unsure</source>
        <translation>3  Kararsız</translation>
    </message>
    <message>
        <source>Best score first</source>
        <translation>Puana göre</translation>
    </message>
    <message>
        <source>Each picture: ± {half} around the moment, colours from {low} to {high} dB. There is no path, so nothing can be said in metres.</source>
        <translation>Her resim: anın ± {half} çevresi, renkler {low} ile {high} dB arası. Yol olmadığı için metre olarak bir şey söylenemez.</translation>
    </message>
    <message>
        <source>Each picture: ± {half} around the place, colours from {low} to {high} dB. Brackets: 95 % interval. Strokes at the sides: band. Curve: level over the background, dashed: threshold.</source>
        <translation>Her resim: yerin ± {half} çevresi, renkler {low} ile {high} dB arası. Köşeli çizgiler: %95 aralığı. Yanlardaki çizgiler: bant. Eğri: arka plana göre düzey, kesikli: eşik.</translation>
    </message>
    <message>
        <source>Enter  Open</source>
        <translation>Enter  Aç</translation>
    </message>
    <message>
        <source>From the launch on</source>
        <translation>Hat metresine göre</translation>
    </message>
    <message>
        <source>Larger (Z)</source>
        <translation>Daha büyük (Z)</translation>
    </message>
    <message>
        <source>N  Filter</source>
        <translation>N  Süzgeç</translation>
    </message>
    <message>
        <source>No leak candidates were found. M marks one by hand on the leaks page.</source>
        <translation>Kaçak adayı bulunamadı. Kaçaklar sayfasında M tuşu elle işaretler.</translation>
    </message>
    <message>
        <source>O  Leaks page</source>
        <translation>O  Kaçaklar sayfası</translation>
    </message>
    <message>
        <source>Order of the gallery</source>
        <translation>Galerinin sırası</translation>
    </message>
    <message>
        <source>Smaller pictures (X)</source>
        <translation>Daha küçük resimler (X)</translation>
    </message>
    <message>
        <source>The filter hides all candidates. N shows the next filter.</source>
        <translation>Süzgeç tüm adayları gizliyor. N sonraki süzgece geçer.</translation>
    </message>
    <message>
        <source>{count} shown by the filter</source>
        <translation>süzgeçle gösterilen: {count}</translation>
    </message>
    <message>
        <source>{decided} of {all} decided</source>
        <translation>Karar: {decided} / {all}</translation>
    </message>
    <message>
        <source>⇧Space  Listen</source>
        <translation>⇧Boşluk  Dinle</translation>
    </message>
</context>
<context>
    <name>Gestures</name>
    <message>
        <source>Click in a view</source>
        <translation>Bir görünümde tıklama</translation>
    </message>
    <message>
        <source>Click on a candidate's mark</source>
        <translation>Bir adayın işaretine tıklama</translation>
    </message>
    <message>
        <source>Closer or wider, around the pointer</source>
        <translation>İşaretçinin çevresinde yakınlaştırır ya da uzaklaştırır</translation>
    </message>
    <message>
        <source>Double click</source>
        <translation>Çift tıklama</translation>
    </message>
    <message>
        <source>Drag</source>
        <translation>Sürükleme</translation>
    </message>
    <message>
        <source>Drag a border between views</source>
        <translation>Görünümler arasındaki kenarı sürükleme</translation>
    </message>
    <message>
        <source>Drag a tie point</source>
        <translation>Bağlama noktasını sürükleme</translation>
    </message>
    <message>
        <source>Drop a folder or a map on the window</source>
        <translation>Pencereye klasör ya da harita bırakma</translation>
    </message>
    <message>
        <source>Give one more room; it is remembered</source>
        <translation>Birine daha çok yer verir; hatırlanır</translation>
    </message>
    <message>
        <source>Go there, close enough to see it</source>
        <translation>Görülecek kadar yakından oraya gider</translation>
    </message>
    <message>
        <source>Mouse and fingers</source>
        <translation>Fare ve parmaklar</translation>
    </message>
    <message>
        <source>Move it; the path follows at once</source>
        <translation>Onu taşır; yol hemen uyar</translation>
    </message>
    <message>
        <source>Move what is shown</source>
        <translation>Görüneni kaydırır</translation>
    </message>
    <message>
        <source>Open the folder, or import the route</source>
        <translation>Klasörü açar ya da güzergâhı içe aktarır</translation>
    </message>
    <message>
        <source>Press a light</source>
        <translation>Bir ışığa basma</translation>
    </message>
    <message>
        <source>Put the cursor there; all views follow</source>
        <translation>İmleci oraya getirir; bütün görünümler izler</translation>
    </message>
    <message>
        <source>Say what that step lacks, and lead there</source>
        <translation>O adımda neyin eksik olduğunu söyler ve oraya götürür</translation>
    </message>
    <message>
        <source>Select a stretch and a band</source>
        <translation>Bir kesim ve bir bant seçer</translation>
    </message>
    <message>
        <source>Select that candidate</source>
        <translation>O adayı seçer</translation>
    </message>
    <message>
        <source>Shift and drag in the spectrogram</source>
        <translation>Spektrogramda Shift ile sürükleme</translation>
    </message>
    <message>
        <source>Wheel, or two fingers apart</source>
        <translation>Tekerlek ya da iki parmağı açma</translation>
    </message>
</context>
<context>
    <name>GuideControl</name>
    <message>
        <source>Data</source>
        <translation>Veri</translation>
    </message>
    <message>
        <source>Leaks</source>
        <translation>Kaçaklar</translation>
    </message>
    <message>
        <source>Path</source>
        <translation>Yol</translation>
    </message>
    <message>
        <source>Process</source>
        <translation>İşle</translation>
    </message>
    <message>
        <source>Report</source>
        <translation>Rapor</translation>
    </message>
    <message>
        <source>Sound</source>
        <translation>Ses</translation>
    </message>
    <message>
        <source>Tie points</source>
        <translation>Bağlama noktaları</translation>
    </message>
    <message>
        <source>To the form</source>
        <translation>Forma git</translation>
    </message>
    <message>
        <source>To the tie points</source>
        <translation>Bağlama noktalarına git</translation>
    </message>
    <message>
        <source>the pipe's length</source>
        <translation>boru uzunluğu</translation>
    </message>
</context>
<context>
    <name>HandoverForm</name>
    <message>
        <source>All</source>
        <translation>Hepsi</translation>
    </message>
    <message>
        <source>All of it also as one zip file</source>
        <translation>Hepsini tek zip dosyası olarak da</translation>
    </message>
    <message>
        <source>Coordinate system of the map files</source>
        <translation>Harita dosyalarının koordinat sistemi</translation>
    </message>
    <message>
        <source>DXF (drawing)</source>
        <translation>DXF (çizim)</translation>
    </message>
    <message>
        <source>Excel tables</source>
        <translation>Excel tabloları</translation>
    </message>
    <message>
        <source>Files for others</source>
        <translation>Başkaları için dosyalar</translation>
    </message>
    <message>
        <source>GPX (GPS receivers)</source>
        <translation>GPX (GPS alıcısı)</translation>
    </message>
    <message>
        <source>GeoPackage (QGIS)</source>
        <translation>GeoPackage (QGIS)</translation>
    </message>
    <message>
        <source>KML (Google Earth)</source>
        <translation>KML (Google Earth)</translation>
    </message>
    <message>
        <source>Leakline's, with their unit</source>
        <translation>Leakline'ın adları, birimiyle</translation>
    </message>
    <message>
        <source>Lengths in tables</source>
        <translation>Tablolarda uzunluk</translation>
    </message>
    <message>
        <source>Log of decisions</source>
        <translation>Karar günlüğü</translation>
    </message>
    <message>
        <source>Names of columns</source>
        <translation>Sütun adları</translation>
    </message>
    <message>
        <source>None</source>
        <translation>Hiçbiri</translation>
    </message>
    <message>
        <source>Number of the pipe</source>
        <translation>Boru numarası</translation>
    </message>
    <message>
        <source>Raven (sound)</source>
        <translation>Raven (ses)</translation>
    </message>
    <message>
        <source>Shapefile (GIS)</source>
        <translation>Shapefile (CBS)</translation>
    </message>
    <message>
        <source>Tables and map files</source>
        <translation>Tablolar ve harita dosyaları</translation>
    </message>
    <message>
        <source>The launch has no known place: map files are in local metres, KML and GPX are left out.</source>
        <translation>Bırakma noktasının yeri bilinmiyor: harita dosyaları yerel metredir, KML ve GPX yazılmaz.</translation>
    </message>
    <message>
        <source>US survey feet</source>
        <translation>ABD ölçme ayağı</translation>
    </message>
    <message>
        <source>as the asset system has it</source>
        <translation>varlık sisteminde yazdığı gibi</translation>
    </message>
    <message>
        <source>for asset systems: pipe_id, leak_distance, x, y</source>
        <translation>varlık sistemleri için: pipe_id, leak_distance, x, y</translation>
    </message>
    <message>
        <source>metres</source>
        <translation>metre</translation>
    </message>
    <message>
        <source>{crs} (as proposed)</source>
        <translation>{crs} (önerilen)</translation>
    </message>
</context>
<context>
    <name>HelpControl</name>
    <message>
        <source>Leakline: keys and gestures</source>
        <translation>Leakline: tuşlar ve hareketler</translation>
    </message>
    <message>
        <source>Print (PDF)</source>
        <translation>Yazdır (PDF)</translation>
    </message>
    <message>
        <source>Save diagnostics</source>
        <translation>Tanılama dosyasını kaydet</translation>
    </message>
    <message>
        <source>The file could not be written: {reason}. Choose another folder.</source>
        <translation>Dosya yazılamadı: {reason}. Başka bir klasör seçin.</translation>
    </message>
    <message>
        <source>Written to {folder}</source>
        <translation>Yazıldı: {folder}</translation>
    </message>
</context>
<context>
    <name>ImportPreview</name>
    <message>
        <source>File</source>
        <translation>Dosya</translation>
    </message>
    <message>
        <source>Files</source>
        <translation>Dosyalar</translation>
    </message>
    <message>
        <source>First rows</source>
        <translation>İlk satırlar</translation>
    </message>
    <message>
        <source>Size</source>
        <translation>Boyut</translation>
    </message>
    <message>
        <source>Taken for</source>
        <translation>Türü</translation>
    </message>
</context>
<context>
    <name>ImuView</name>
    <message>
        <source>Motion sensor</source>
        <translation>Hareket sensörü</translation>
    </message>
    <message>
        <source>No motion data: the data page says why</source>
        <translation>Hareket verisi yok: nedeni veri sayfasında</translation>
    </message>
    <message>
        <source>Reading …</source>
        <translation>Okunuyor …</translation>
    </message>
    <message>
        <source>force</source>
        <translation>ivme</translation>
    </message>
    <message>
        <source>m/s²</source>
        <translation>m/s²</translation>
    </message>
    <message>
        <source>speed</source>
        <translation>hız</translation>
    </message>
    <message>
        <source>turn rate</source>
        <translation>dönme</translation>
    </message>
    <message>
        <source>°/s</source>
        <translation>°/s</translation>
    </message>
</context>
<context>
    <name>JobLine</name>
    <message>
        <source>Cancel</source>
        <translation>İptal</translation>
    </message>
    <message>
        <source>Stopping …</source>
        <translation>Durduruluyor …</translation>
    </message>
</context>
<context>
    <name>KeySheetWindow</name>
    <message>
        <source>Close</source>
        <translation>Kapat</translation>
    </message>
    <message>
        <source>Keys</source>
        <translation>Tuşlar</translation>
    </message>
    <message>
        <source>Keys and gestures</source>
        <translation>Tuşlar ve hareketler</translation>
    </message>
    <message>
        <source>Larger letters</source>
        <translation>Daha büyük yazı</translation>
    </message>
    <message>
        <source>No key does that. Search for fewer words, or look into the menus.</source>
        <translation>Bunu yapan bir tuş yok. Daha az sözcükle arayın ya da menülere bakın.</translation>
    </message>
    <message>
        <source>Print (PDF)…</source>
        <translation>Yazdır (PDF)…</translation>
    </message>
    <message>
        <source>Search: what it does, or a key</source>
        <translation>Ara: ne yaptığı ya da bir tuş</translation>
    </message>
    <message>
        <source>Smaller letters</source>
        <translation>Daha küçük yazı</translation>
    </message>
    <message>
        <source>Write the sheet as a PDF to print</source>
        <translation>Sayfayı yazdırmak için PDF olarak kaydeder</translation>
    </message>
</context>
<context>
    <name>KnownLeakDialog</name>
    <message>
        <source>Cancel</source>
        <translation>Vazgeç</translation>
    </message>
    <message>
        <source>Flow ({unit})</source>
        <translation>Debi ({unit})</translation>
    </message>
    <message>
        <source>Known leak</source>
        <translation>Bilinen kaçak</translation>
    </message>
    <message>
        <source>No known leak</source>
        <translation>Bilinen kaçak değil</translation>
    </message>
    <message>
        <source>Pressure ({unit})</source>
        <translation>Basınç ({unit})</translation>
    </message>
    <message>
        <source>Size others beside it</source>
        <translation>Ötekileri bununla ölç</translation>
    </message>
    <message>
        <source>needed</source>
        <translation>gerekli</translation>
    </message>
    <message>
        <source>not known</source>
        <translation>bilinmiyor</translation>
    </message>
    <message>
        <source>{name}: how much water came out here while the device passed? A tap opened near the launch and measured with a bucket will do. Other leaks of this run are then sized beside it.</source>
        <translation>{name}: aygıt geçerken buradan ne kadar su çıktı? Bırakma noktası yakınında açılıp kovayla ölçülen bir musluk yeter. Bu geçişteki öteki kaçakların büyüklüğü bununla ölçülür.</translation>
    </message>
</context>
<context>
    <name>LevelMeter</name>
    <message>
        <source>CLIP</source>
        <translation>TAŞMA</translation>
    </message>
    <message>
        <source>Level in dB below full scale. Click or press Q to put out the clip light</source>
        <translation>Tam ölçeğe göre dB olarak seviye. Taşma ışığını söndürmek için tıklayın veya Q tuşuna basın</translation>
    </message>
    <message>
        <source>Level meter</source>
        <translation>Seviye göstergesi</translation>
    </message>
    <message>
        <source>clipped: too loud</source>
        <translation>taştı: ses fazla yüksek</translation>
    </message>
</context>
<context>
    <name>LevelView</name>
    <message>
        <source>Level along the pipe</source>
        <translation>Boru boyunca düzey</translation>
    </message>
    <message>
        <source>No level yet: process the recording first</source>
        <translation>Henüz düzey yok: önce kaydı işleyin</translation>
    </message>
    <message>
        <source>background</source>
        <translation>arka plan</translation>
    </message>
    <message>
        <source>dB</source>
        <translation>dB</translation>
    </message>
    <message>
        <source>level</source>
        <translation>düzey</translation>
    </message>
    <message>
        <source>level {band}</source>
        <translation>düzey {band}</translation>
    </message>
    <message>
        <source>threshold</source>
        <translation>eşik</translation>
    </message>
</context>
<context>
    <name>ListControl</name>
    <message>
        <source>Candidates are played by key only</source>
        <translation>Adaylar yalnızca tuşla çalınır</translation>
    </message>
    <message>
        <source>Each candidate is played on arrival</source>
        <translation>Her aday, gelindiğinde çalınır</translation>
    </message>
    <message>
        <source>List: {what}</source>
        <translation>Liste: {what}</translation>
    </message>
    <message>
        <source>all</source>
        <translation>hepsi</translation>
    </message>
    <message>
        <source>reject {count} below {score}</source>
        <translation>{score} altındaki {count} adayı reddetme</translation>
    </message>
</context>
<context>
    <name>ListTools</name>
    <message>
        <source>All</source>
        <translation>Hepsi</translation>
    </message>
    <message>
        <source>All {all} decided: to the report (Ctrl+5)</source>
        <translation>{all} adayın hepsi tamam: rapora git (Ctrl+5)</translation>
    </message>
    <message>
        <source>All {all} judged: compare (Ctrl+J)</source>
        <translation>{all} adayın hepsi tamam: karşılaştır (Ctrl+J)</translation>
    </message>
    <message>
        <source>Clear filter</source>
        <translation>Süzgeci kaldır</translation>
    </message>
    <message>
        <source>Clear the filter: show all candidates</source>
        <translation>Süzgeci kaldır: bütün adayları göster</translation>
    </message>
    <message>
        <source>More…</source>
        <translation>Diğer…</translation>
    </message>
    <message>
        <source>Order, filter by class and score, listening on arrival (Shift+N)</source>
        <translation>Sıra, sınıfa ve puana göre süzme, gelince dinleme (Shift+N)</translation>
    </message>
    <message>
        <source>Undecided and hidden by the filter: {count}</source>
        <translation>Karar bekleyen, süzgecin gizlediği: {count}</translation>
    </message>
    <message>
        <source>Which candidates are shown (N)</source>
        <translation>Hangi adaylar gösterilsin (N)</translation>
    </message>
    <message>
        <source>{decided} of {all} decided</source>
        <translation>Karar: {decided} / {all}</translation>
    </message>
    <message>
        <source>{shown} of {all} shown</source>
        <translation>Görünen: {shown} / {all}</translation>
    </message>
    <message>
        <source>✕ Filter</source>
        <translation>✕ Süzgeç</translation>
    </message>
</context>
<context>
    <name>LivePathView</name>
    <message>
        <source>? last known place</source>
        <translation>? bilinen son yer</translation>
    </message>
    <message>
        <source>Live path</source>
        <translation>Canlı yol</translation>
    </message>
    <message>
        <source>No path yet</source>
        <translation>Henüz yol yok</translation>
    </message>
    <message>
        <source>■ still</source>
        <translation>■ duruyor</translation>
    </message>
    <message>
        <source>▶ moving</source>
        <translation>▶ hareket ediyor</translation>
    </message>
</context>
<context>
    <name>LiveSpectrogram</name>
    <message>
        <source>Live spectrogram</source>
        <translation>Canlı spektrogram</translation>
    </message>
    <message>
        <source>No sound yet</source>
        <translation>Henüz ses yok</translation>
    </message>
    <message>
        <source>now</source>
        <translation>şimdi</translation>
    </message>
    <message>
        <source>{seconds} s ago</source>
        <translation>{seconds} s önce</translation>
    </message>
</context>
<context>
    <name>LiveStrips</name>
    <message>
        <source>Live motion</source>
        <translation>Canlı hareket</translation>
    </message>
    <message>
        <source>No motion yet</source>
        <translation>Henüz hareket verisi yok</translation>
    </message>
</context>
<context>
    <name>MainWindow</name>
    <message>
        <source>Data</source>
        <translation>Veri</translation>
    </message>
    <message>
        <source>Leaks</source>
        <translation>Kaçaklar</translation>
    </message>
    <message>
        <source>Looking for a sound card</source>
        <translation>Ses kartı aranıyor</translation>
    </message>
    <message>
        <source>Path</source>
        <translation>Yol</translation>
    </message>
    <message>
        <source>Please wait until the work in progress has ended.</source>
        <translation>Lütfen süren işin bitmesini bekleyin.</translation>
    </message>
    <message>
        <source>Report</source>
        <translation>Rapor</translation>
    </message>
    <message>
        <source>Sound</source>
        <translation>Ses</translation>
    </message>
</context>
<context>
    <name>ManualWindow</name>
    <message>
        <source>Close</source>
        <translation>Kapat</translation>
    </message>
    <message>
        <source>Contents</source>
        <translation>İçindekiler</translation>
    </message>
    <message>
        <source>Forward →</source>
        <translation>İleri →</translation>
    </message>
    <message>
        <source>Manual</source>
        <translation>Kılavuz</translation>
    </message>
    <message>
        <source>No page has all of these words. Search for fewer of them.</source>
        <translation>Hiçbir sayfada bu sözcüklerin hepsi yok. Daha az sözcükle arayın.</translation>
    </message>
    <message>
        <source>Page of the manual</source>
        <translation>Kılavuz sayfası</translation>
    </message>
    <message>
        <source>Search the manual</source>
        <translation>Kılavuzda ara</translation>
    </message>
    <message>
        <source>← Back</source>
        <translation>← Geri</translation>
    </message>
</context>
<context>
    <name>MarkControl</name>
    <message>
        <source>Only a mark made by hand can be moved: select one, or press M for a new one.</source>
        <translation>Yalnızca elle konan işaret kaydırılabilir: birini seçin ya da yenisi için M'ye basın.</translation>
    </message>
    <message>
        <source>move {name}</source>
        <translation>{name} kaydırma</translation>
    </message>
</context>
<context>
    <name>MarkerLine</name>
    <message>
        <source>Chainage ({unit})</source>
        <translation>Hat metresi ({unit})</translation>
    </message>
    <message>
        <source>Name of the marker</source>
        <translation>İşaretin adı</translation>
    </message>
    <message>
        <source>Store</source>
        <translation>Sakla</translation>
    </message>
    <message>
        <source>Store (Enter); Escape keeps the moment with its number</source>
        <translation>Saklar (Enter); Esc anı numarasıyla bırakır</translation>
    </message>
    <message>
        <source>{unit} from launch</source>
        <translation>bırakmadan {unit}</translation>
    </message>
</context>
<context>
    <name>MarkerModel</name>
    <message>
        <source>All others contradict it, so it is not believed: check its place and its time.</source>
        <translation>Ötekilerin hepsiyle çelişiyor, bu yüzden ona inanılmıyor: yerini ve zamanını denetleyin.</translation>
    </message>
    <message>
        <source>At ({unit})</source>
        <translation>Yer ({unit})</translation>
    </message>
    <message>
        <source>Fits to</source>
        <translation>Uyum</translation>
    </message>
    <message>
        <source>If we had not known it, the path would have been off here by {length}.</source>
        <translation>Bunu bilmeseydik yol burada {length} şaşardı.</translation>
    </message>
    <message>
        <source>Time (s)</source>
        <translation>Zaman (s)</translation>
    </message>
    <message>
        <source>Without it</source>
        <translation>O olmasa</translation>
    </message>
    <message>
        <source>± 1σ</source>
        <translation>± 1σ</translation>
    </message>
</context>
<context>
    <name>MarkerPanel</name>
    <message>
        <source>Add at cursor</source>
        <translation>İmlece ekle</translation>
    </message>
    <message>
        <source>Drag a square on the plan to its place, or its flag on a strip to its moment; Esc puts it back. 'Without it': how far off we would be here, had we not known it.</source>
        <translation>Plandaki kareyi yerine ya da şeritteki bayrağını anına sürükleyin; Esc geri koyar. 'O olmasa': bunu bilmeseydik burada ne kadar şaşardık.</translation>
    </message>
    <message>
        <source>Ended where it began</source>
        <translation>Başladığı yerde bitti</translation>
    </message>
    <message>
        <source>Keep this moment at once; name the place afterwards</source>
        <translation>Bu anı hemen saklar; yerin adı sonra yazılır</translation>
    </message>
    <message>
        <source>Markers</source>
        <translation>İşaretler</translation>
    </message>
    <message>
        <source>No markers yet</source>
        <translation>Henüz işaret yok</translation>
    </message>
    <message>
        <source>Passing now (M)</source>
        <translation>Şimdi geçiyor (M)</translation>
    </message>
    <message>
        <source>Place the leaks anew</source>
        <translation>Kaçakları yeniden yerleştir</translation>
    </message>
    <message>
        <source>Remove</source>
        <translation>Sil</translation>
    </message>
    <message>
        <source>Take the last marker back (Ctrl+Z)</source>
        <translation>Son işareti geri alır (Ctrl+Z)</translation>
    </message>
    <message>
        <source>Tie points</source>
        <translation>Bağlama noktaları</translation>
    </message>
    <message>
        <source>Undo</source>
        <translation>Geri al</translation>
    </message>
</context>
<context>
    <name>MeasureControl</name>
    <message>
        <source>Length with its 95 % interval, time, mean speed and step in level from the first end to the second. The errors of the two ends are taken as independent, so the true interval is at most this wide: close to each other, both ends are off by nearly the same.</source>
        <translation>% 95 aralığıyla uzunluk, süre, ortalama hız ve ilk uçtan ikinciye seviye farkı. İki ucun hataları bağımsız sayılır; gerçek aralık en çok bu kadar geniştir: birbirine yakın uçlar hemen hemen aynı kadar kayar.</translation>
    </message>
    <message>
        <source>{seconds} s</source>
        <translation>{seconds} s</translation>
    </message>
</context>
<context>
    <name>MessageBoxes</name>
    <message>
        <source>OK</source>
        <translation>Tamam</translation>
    </message>
</context>
<context>
    <name>MessageList</name>
    <message>
        <source>Messages</source>
        <translation>İletiler</translation>
    </message>
</context>
<context>
    <name>MethodPanel</name>
    <message>
        <source>Clear</source>
        <translation>Temizle</translation>
    </message>
    <message>
        <source>Each method's path by itself: no tie point, no length and no map pulls on it.</source>
        <translation>Her yöntemin kendi başına bulduğu yol: bağlama noktası, uzunluk ya da harita onu çekmez.</translation>
    </message>
    <message>
        <source>End off</source>
        <translation>Son farkı</translation>
    </message>
    <message>
        <source>Length off</source>
        <translation>Uzunluk farkı</translation>
    </message>
    <message>
        <source>Method</source>
        <translation>Yöntem</translation>
    </message>
    <message>
        <source>Methods</source>
        <translation>Yöntemler</translation>
    </message>
    <message>
        <source>Try the ticked ones</source>
        <translation>İşaretlileri dene</translation>
    </message>
    <message>
        <source>Use this one</source>
        <translation>Bunu kullan</translation>
    </message>
    <message>
        <source>Way found: {length}</source>
        <translation>Bulunan yol: {length}</translation>
    </message>
    <message>
        <source>cannot</source>
        <translation>olmuyor</translation>
    </message>
</context>
<context>
    <name>Notices</name>
    <message>
        <source>Demonstration (simulated): nothing here is a real pipe</source>
        <translation>Tanıtım (benzetim): buradaki hiçbir şey gerçek bir boru değil</translation>
    </message>
    <message>
        <source>Earlier verdicts without a candidate: {count}, see the data page</source>
        <translation>Adayı kalmamış eski karar: {count}, veri sayfasına bakın</translation>
    </message>
    <message>
        <source>Not assessed (hatched): {count}</source>
        <translation>Değerlendirilmeyen (taralı): {count}</translation>
    </message>
    <message>
        <source>Read-only: nothing can be changed</source>
        <translation>Salt okunur: hiçbir şey değiştirilemez</translation>
    </message>
    <message>
        <source>Second review by {name}, blind: Ctrl+J ends it</source>
        <translation>İkinci inceleme (kör): {name}. Ctrl+J bitirir</translation>
    </message>
</context>
<context>
    <name>OptionalNumber</name>
    <message>
        <source>Allowed: {low} … {high}</source>
        <translation>İzin verilen: {low} … {high}</translation>
    </message>
</context>
<context>
    <name>OverviewStrip</name>
    <message>
        <source>Overview of the whole run</source>
        <translation>Bütün geçişe genel bakış</translation>
    </message>
</context>
<context>
    <name>PagePanels</name>
    <message>
        <source>Elevation profile</source>
        <translation>Yükseklik profili</translation>
    </message>
    <message>
        <source>Level</source>
        <translation>Seviye</translation>
    </message>
    <message>
        <source>List and verdict</source>
        <translation>Liste ve karar</translation>
    </message>
    <message>
        <source>Motion</source>
        <translation>Hareket</translation>
    </message>
    <message>
        <source>Overview of the run</source>
        <translation>Ölçüme genel bakış</translation>
    </message>
    <message>
        <source>Panels</source>
        <translation>Paneller</translation>
    </message>
    <message>
        <source>Plan</source>
        <translation>Plan</translation>
    </message>
    <message>
        <source>Spectrogram</source>
        <translation>Spektrogram</translation>
    </message>
</context>
<context>
    <name>PagePictures</name>
    <message>
        <source>Larger</source>
        <translation>Büyüt</translation>
    </message>
    <message>
        <source>Next ▶</source>
        <translation>Sonraki ▶</translation>
    </message>
    <message>
        <source>Page {page} of {count}</source>
        <translation>Sayfa {page} / {count}</translation>
    </message>
    <message>
        <source>Pages of the report</source>
        <translation>Raporun sayfaları</translation>
    </message>
    <message>
        <source>Whole page</source>
        <translation>Tüm sayfa</translation>
    </message>
    <message>
        <source>◀ Back</source>
        <translation>◀ Önceki</translation>
    </message>
</context>
<context>
    <name>PartsPlot</name>
    <message>
        <source>Delay in each part of the recording</source>
        <translation>Kaydın her bölümündeki gecikme</translation>
    </message>
    <message>
        <source>Here stands whether the sound is there all the time.</source>
        <translation>Sesin sürekli var olup olmadığı burada görünür.</translation>
    </message>
    <message>
        <source>delay (ms)</source>
        <translation>gecikme (ms)</translation>
    </message>
    <message>
        <source>heard</source>
        <translation>duyuldu</translation>
    </message>
    <message>
        <source>not heard</source>
        <translation>duyulmadı</translation>
    </message>
    <message>
        <source>seconds of the recording</source>
        <translation>kaydın saniyeleri</translation>
    </message>
</context>
<context>
    <name>PathView</name>
    <message>
        <source>N</source>
        <translation>K</translation>
    </message>
    <message>
        <source>No path yet: process the recording first</source>
        <translation>Henüz yol yok: önce kaydı işleyin</translation>
    </message>
    <message>
        <source>Path from above</source>
        <translation>Yolun planı</translation>
    </message>
    <message>
        <source>launch</source>
        <translation>bırakma</translation>
    </message>
    <message>
        <source>retrieval</source>
        <translation>çıkarma</translation>
    </message>
</context>
<context>
    <name>PhasePlot</name>
    <message>
        <source>Phase beside the fitted line</source>
        <translation>Uydurulan doğrunun yanında kalan faz</translation>
    </message>
    <message>
        <source>Too few frequencies agree for a fit of the phase.</source>
        <translation>Faza doğru uydurmak için uyuşan frekans çok az.</translation>
    </message>
    <message>
        <source>frequency (Hz)</source>
        <translation>frekans (Hz)</translation>
    </message>
    <message>
        <source>phase left (°)</source>
        <translation>kalan faz (°)</translation>
    </message>
</context>
<context>
    <name>PhotoControl</name>
    <message>
        <source>Attach photos</source>
        <translation>Fotoğraf ekle</translation>
    </message>
    <message>
        <source>Copying photos</source>
        <translation>Fotoğraflar kopyalanıyor</translation>
    </message>
    <message>
        <source>Is it a photo of this leak?</source>
        <translation>Bu kaçağın fotoğrafı mı?</translation>
    </message>
    <message>
        <source>Photos</source>
        <translation>Fotoğraflar</translation>
    </message>
    <message>
        <source>Photos not attached: their survey was closed while they were copied. Attach them again.</source>
        <translation>Fotoğraflar eklenmedi: kopyalanırken ölçüm kapatıldı. Yeniden ekleyin.</translation>
    </message>
    <message>
        <source>Pictures</source>
        <translation>Resimler</translation>
    </message>
    <message>
        <source>Taken at {place}.</source>
        <translation>Çekildiği yer: {place}.</translation>
    </message>
    <message>
        <source>Taken {day}, {time}.</source>
        <translation>Çekim: {day}, {time}.</translation>
    </message>
    <message>
        <source>The photo does not say where it was taken.</source>
        <translation>Fotoğrafta çekildiği yer yazmıyor.</translation>
    </message>
    <message>
        <source>There is no picture in the clipboard. Copy one first.</source>
        <translation>Panoda resim yok. Önce bir resim kopyalayın.</translation>
    </message>
    <message>
        <source>This photo is attached to {name} already.</source>
        <translation>Bu fotoğraf {name} için zaten eklenmiş.</translation>
    </message>
    <message>
        <source>This photo was taken {metres} from the stated place.</source>
        <translation>Bu fotoğraf belirtilen yerden {metres} uzakta çekilmiş.</translation>
    </message>
    <message>
        <source>caption of {name}</source>
        <translation>{name} fotoğraf yazısı</translation>
    </message>
    <message>
        <source>photo of {name}</source>
        <translation>{name} fotoğrafı</translation>
    </message>
    <message>
        <source>remove photo of {name}</source>
        <translation>{name} fotoğrafını kaldır</translation>
    </message>
</context>
<context>
    <name>PhotoDialog</name>
    <message>
        <source>Photo</source>
        <translation>Fotoğraf</translation>
    </message>
    <message>
        <source>The photo is being read…</source>
        <translation>Fotoğraf okunuyor…</translation>
    </message>
</context>
<context>
    <name>PhotoPanel</name>
    <message>
        <source>Caption</source>
        <translation>Açıklama</translation>
    </message>
    <message>
        <source>Caption of the photo</source>
        <translation>Fotoğrafın açıklaması</translation>
    </message>
    <message>
        <source>Ctrl+V  Paste</source>
        <translation>Ctrl+V  Yapıştır</translation>
    </message>
    <message>
        <source>No candidate selected</source>
        <translation>Aday seçilmedi</translation>
    </message>
    <message>
        <source>No photo yet. Attach one, paste it, or drop it here.</source>
        <translation>Henüz fotoğraf yok. Ekleyin, yapıştırın ya da buraya bırakın.</translation>
    </message>
    <message>
        <source>No photo.</source>
        <translation>Fotoğraf yok.</translation>
    </message>
    <message>
        <source>Photos of this leak</source>
        <translation>Bu kaçağın fotoğrafları</translation>
    </message>
    <message>
        <source>Remove photo</source>
        <translation>Fotoğrafı kaldır</translation>
    </message>
    <message>
        <source>Show large</source>
        <translation>Büyüt</translation>
    </message>
    <message>
        <source>The photo is being read…</source>
        <translation>Fotoğraf okunuyor…</translation>
    </message>
    <message>
        <source>photo {number}</source>
        <translation>fotoğraf {number}</translation>
    </message>
    <message>
        <source>{name}: photos: {count}</source>
        <translation>{name}: fotoğraf: {count}</translation>
    </message>
    <message>
        <source>⇧P  Attach…</source>
        <translation>⇧P  Ekle…</translation>
    </message>
</context>
<context>
    <name>PipeSketch</name>
    <message>
        <source>Sketch of the pipe</source>
        <translation>Borunun çizimi</translation>
    </message>
    <message>
        <source>{length} m {material}, {speed} m/s</source>
        <translation>{length} m {material}, {speed} m/s</translation>
    </message>
    <message>
        <source>{metres} m</source>
        <translation>{metres} m</translation>
    </message>
</context>
<context>
    <name>PipeTable</name>
    <message>
        <source>A to B (m)</source>
        <translation>A–B (m)</translation>
    </message>
    <message>
        <source>Add section</source>
        <translation>Kesim ekle</translation>
    </message>
    <message>
        <source>Length m</source>
        <translation>Uzunluk m</translation>
    </message>
    <message>
        <source>Material</source>
        <translation>Malzeme</translation>
    </message>
    <message>
        <source>Remove last</source>
        <translation>Sonuncuyu sil</translation>
    </message>
    <message>
        <source>Speed m/s</source>
        <translation>Hız m/s</translation>
    </message>
    <message>
        <source>The whole distance from A to B as measured: a check of the sections</source>
        <translation>A'dan B'ye ölçülen toplam uzaklık: kesimlerin denetimi</translation>
    </message>
    <message>
        <source>Wall mm</source>
        <translation>Et mm</translation>
    </message>
    <message>
        <source>not measured</source>
        <translation>ölçülmedi</translation>
    </message>
    <message>
        <source>±</source>
        <translation>±</translation>
    </message>
    <message>
        <source>Ø mm</source>
        <translation>Ø mm</translation>
    </message>
</context>
<context>
    <name>PlaybackBar</name>
    <message>
        <source>All of it</source>
        <translation>Sesin tamamı</translation>
    </message>
    <message>
        <source>Candidate's band</source>
        <translation>Adayın bandı</translation>
    </message>
    <message>
        <source>Cleaned</source>
        <translation>Temizlenmiş</translation>
    </message>
    <message>
        <source>How fast it is heard, at the same pitch (S)</source>
        <translation>Ne hızda duyulsun, aynı perdede (S)</translation>
    </message>
    <message>
        <source>Leak band</source>
        <translation>Kaçak bandı</translation>
    </message>
    <message>
        <source>Loop candidate</source>
        <translation>Adayı tekrarla</translation>
    </message>
    <message>
        <source>Pause</source>
        <translation>Duraklat</translation>
    </message>
    <message>
        <source>Play</source>
        <translation>Çal</translation>
    </message>
    <message>
        <source>Play or pause (Space)</source>
        <translation>Çal ya da duraklat (Boşluk)</translation>
    </message>
    <message>
        <source>Play the candidate again and again (Shift+Space)</source>
        <translation>Adayı durmadan tekrarla (Shift+Boşluk)</translation>
    </message>
    <message>
        <source>Raw sound, or without the noise of the ball's own rolling, in sound and picture (A)</source>
        <translation>Ham ses ya da topun kendi yuvarlanma gürültüsü olmadan, seste ve görüntüde (A)</translation>
    </message>
    <message>
        <source>Volume</source>
        <translation>Ses düzeyi</translation>
    </message>
    <message>
        <source>What is heard (B)</source>
        <translation>Ne duyulsun (B)</translation>
    </message>
</context>
<context>
    <name>Player</name>
    <message>
        <source>No sound card</source>
        <translation>Ses kartı yok</translation>
    </message>
    <message>
        <source>This survey has no sound.</source>
        <translation>Bu ölçümde ses yok.</translation>
    </message>
</context>
<context>
    <name>PlotFrame</name>
    <message>
        <source>time</source>
        <translation>zaman</translation>
    </message>
</context>
<context>
    <name>PrelaunchPanel</name>
    <message>
        <source>Break off</source>
        <translation>Vazgeç</translation>
    </message>
    <message>
        <source>Check before the launch</source>
        <translation>Gönderimden önce denetle</translation>
    </message>
    <message>
        <source>Expected speed (m/s)</source>
        <translation>Beklenen hız (m/s)</translation>
    </message>
    <message>
        <source>Heard {heard}, felt {felt}, both {both}.</source>
        <translation>Duyulan {heard}, hissedilen {felt}, ikisi de {both}.</translation>
    </message>
    <message>
        <source>Knock again before you stop: it settles the drift of the clocks</source>
        <translation>Durdurmadan önce yeniden vurun: saatlerin kayması böyle belirlenir</translation>
    </message>
    <message>
        <source>Knocks at the end</source>
        <translation>Sondaki vuruşlar</translation>
    </message>
    <message>
        <source>Range of the gyro</source>
        <translation>Jiroskop aralığı</translation>
    </message>
    <message>
        <source>Skip this step</source>
        <translation>Bu adımı atla</translation>
    </message>
    <message>
        <source>unknown</source>
        <translation>bilinmiyor</translation>
    </message>
</context>
<context>
    <name>PresetDialog</name>
    <message>
        <source>A row of your own, with the values of this one</source>
        <translation>Bunun değerleriyle kendi satırınız</translation>
    </message>
    <message>
        <source>Add a copy</source>
        <translation>Kopyasını ekle</translation>
    </message>
    <message>
        <source>Allowed</source>
        <translation>İzin verilen</translation>
    </message>
    <message>
        <source>Back to what came with the program; a row of your own goes</source>
        <translation>Programla gelene dön; kendi satırınız silinir</translation>
    </message>
    <message>
        <source>Basis</source>
        <translation>Dayanak</translation>
    </message>
    <message>
        <source>Cancel</source>
        <translation>Vazgeç</translation>
    </message>
    <message>
        <source>Inner diameter from, to (mm)</source>
        <translation>İç çap, en az ve en çok (mm)</translation>
    </message>
    <message>
        <source>Materials, with commas</source>
        <translation>Malzemeler, virgülle</translation>
    </message>
    <message>
        <source>Name</source>
        <translation>Ad</translation>
    </message>
    <message>
        <source>Not possible: {names}</source>
        <translation>Olmaz: {names}</translation>
    </message>
    <message>
        <source>Reset</source>
        <translation>Sıfırla</translation>
    </message>
    <message>
        <source>Save</source>
        <translation>Kaydet</translation>
    </message>
    <message>
        <source>Source</source>
        <translation>Kaynak</translation>
    </message>
    <message>
        <source>Speed of sound (theory)</source>
        <translation>Ses hızı (kuram)</translation>
    </message>
    <message>
        <source>Table of presets</source>
        <translation>Ön ayar tablosu</translation>
    </message>
    <message>
        <source>Value</source>
        <translation>Değer</translation>
    </message>
    <message>
        <source>What</source>
        <translation>Ne</translation>
    </message>
    <message>
        <source>{name} (copy)</source>
        <translation>{name} (kopya)</translation>
    </message>
    <message>
        <source>{name} (own)</source>
        <translation>{name} (kendi)</translation>
    </message>
    <message>
        <source>{speed} m/s</source>
        <translation>{speed} m/s</translation>
    </message>
</context>
<context>
    <name>Presets</name>
    <message>
        <source>Background within ±</source>
        <translation>Arka plan, ±</translation>
    </message>
    <message>
        <source>Diameter over wall</source>
        <translation>Çap / et kalınlığı</translation>
    </message>
    <message>
        <source>Joint to joint (told only)</source>
        <translation>Ekten eke (bilgi)</translation>
    </message>
    <message>
        <source>Large above</source>
        <translation>Büyük, şunun üstünde</translation>
    </message>
    <message>
        <source>Leak band from</source>
        <translation>Kaçak bandı, alt</translation>
    </message>
    <message>
        <source>Leak band to</source>
        <translation>Kaçak bandı, üst</translation>
    </message>
    <message>
        <source>Leak's half-width, least (told only)</source>
        <translation>Kaçağın yarı genişliği, en az (bilgi)</translation>
    </message>
    <message>
        <source>Leak's half-width, most (told only)</source>
        <translation>Kaçağın yarı genişliği, en çok (bilgi)</translation>
    </message>
    <message>
        <source>Loss at 400–800 Hz (told only)</source>
        <translation>400–800 Hz'de kayıp (bilgi)</translation>
    </message>
    <message>
        <source>Loss below 400 Hz (told only)</source>
        <translation>400 Hz altında kayıp (bilgi)</translation>
    </message>
    <message>
        <source>Modulus of the wall</source>
        <translation>Boru duvarının elastisite modülü</translation>
    </message>
    <message>
        <source>Size told from</source>
        <translation>Büyüklük bandı, alt</translation>
    </message>
    <message>
        <source>Size told to</source>
        <translation>Büyüklük bandı, üst</translation>
    </message>
    <message>
        <source>Small below</source>
        <translation>Küçük, şunun altında</translation>
    </message>
    <message>
        <source>measured</source>
        <translation>ölçülmüş</translation>
    </message>
    <message>
        <source>own</source>
        <translation>kendi</translation>
    </message>
    <message>
        <source>theory</source>
        <translation>kuram</translation>
    </message>
    <message>
        <source>usual</source>
        <translation>alışılmış</translation>
    </message>
</context>
<context>
    <name>Preview</name>
    <message>
        <source>form</source>
        <translation>form</translation>
    </message>
    <message>
        <source>journal</source>
        <translation>kayıt günlüğü</translation>
    </message>
    <message>
        <source>motion</source>
        <translation>hareket</translation>
    </message>
    <message>
        <source>not used</source>
        <translation>kullanılmıyor</translation>
    </message>
    <message>
        <source>sound</source>
        <translation>ses</translation>
    </message>
</context>
<context>
    <name>ProfileView</name>
    <message>
        <source>Elevation profile</source>
        <translation>Yükseklik profili</translation>
    </message>
    <message>
        <source>No path yet: process the recording first</source>
        <translation>Henüz yol yok: önce kaydı işleyin</translation>
    </message>
    <message>
        <source>elevation ({unit})</source>
        <translation>yükseklik ({unit})</translation>
    </message>
</context>
<context>
    <name>QShortcut</name>
    <message>
        <source>Ctrl</source>
        <translation>Ctrl</translation>
    </message>
    <message>
        <source>Enter</source>
        <translation>Sayısal Enter</translation>
    </message>
    <message>
        <source>Home</source>
        <translation>Home</translation>
    </message>
    <message>
        <source>PgDown</source>
        <translation>PgDn</translation>
    </message>
    <message>
        <source>PgUp</source>
        <translation>PgUp</translation>
    </message>
    <message>
        <source>Return</source>
        <translation>Enter ↵</translation>
    </message>
    <message>
        <source>Shift</source>
        <translation>Shift</translation>
    </message>
</context>
<context>
    <name>QualityPanel</name>
    <message>
        <source>Reading …</source>
        <translation>Okunuyor …</translation>
    </message>
    <message>
        <source>What to show</source>
        <translation>Gösterilecek</translation>
    </message>
</context>
<context>
    <name>QualityView</name>
    <message>
        <source>Quality of the run</source>
        <translation>Kaydın kalitesi</translation>
    </message>
    <message>
        <source>Reading …</source>
        <translation>Okunuyor …</translation>
    </message>
    <message>
        <source>This run has nothing to show here</source>
        <translation>Bu kayıtta burada gösterilecek bir şey yok</translation>
    </message>
</context>
<context>
    <name>RawForm</name>
    <message>
        <source>16 bit</source>
        <translation>16 bit</translation>
    </message>
    <message>
        <source>24 bit</source>
        <translation>24 bit</translation>
    </message>
    <message>
        <source>32 bit</source>
        <translation>32 bit</translation>
    </message>
    <message>
        <source>32 bit floating point</source>
        <translation>32 bit kayan noktalı</translation>
    </message>
    <message>
        <source>A sample is</source>
        <translation>Bir örnek</translation>
    </message>
    <message>
        <source>Byte order</source>
        <translation>Bayt sırası</translation>
    </message>
    <message>
        <source>Channels</source>
        <translation>Kanal sayısı</translation>
    </message>
    <message>
        <source>Read it so</source>
        <translation>Böyle oku</translation>
    </message>
    <message>
        <source>Samples a second</source>
        <translation>Saniyedeki örnek sayısı</translation>
    </message>
    <message>
        <source>This sound has no header. The device's manual says how it was recorded.</source>
        <translation>Bu sesin başlığı yok. Nasıl kaydedildiği cihazın kılavuzunda yazar.</translation>
    </message>
    <message>
        <source>high byte first</source>
        <translation>önce yüksek bayt</translation>
    </message>
    <message>
        <source>low byte first (usual)</source>
        <translation>önce düşük bayt (olağan)</translation>
    </message>
</context>
<context>
    <name>ReadinessBubble</name>
    <message>
        <source>Close</source>
        <translation>Kapat</translation>
    </message>
    <message>
        <source>Manual: what the lights mean</source>
        <translation>Kılavuz: ışıklar ne anlama gelir</translation>
    </message>
    <message>
        <source>What is missing</source>
        <translation>Neler eksik</translation>
    </message>
</context>
<context>
    <name>RecentSurveyRow</name>
    <message>
        <source>Demonstration</source>
        <translation>Tanıtım</translation>
    </message>
    <message>
        <source>Keep on top</source>
        <translation>Üstte tut</translation>
    </message>
    <message>
        <source>Let go</source>
        <translation>Bırak</translation>
    </message>
    <message>
        <source>Not processed yet</source>
        <translation>Henüz işlenmedi</translation>
    </message>
    <message>
        <source>Not there now: {folder}. Plug the stick in, or take it off the list.</source>
        <translation>Şu an yerinde değil: {folder}. Belleği takın ya da listeden çıkarın.</translation>
    </message>
    <message>
        <source>Take off the list; the survey itself stays (Delete)</source>
        <translation>Listeden çıkar; ölçümün kendisi kalır (Delete)</translation>
    </message>
    <message>
        <source>exported on {day}</source>
        <translation>{day} tarihinde dışa aktarıldı</translation>
    </message>
    <message>
        <source>{count} confirmed</source>
        <translation>{count} onaylı</translation>
    </message>
    <message>
        <source>{done} of {count} decided</source>
        <translation>{count} adaydan {done} tanesine karar verildi</translation>
    </message>
</context>
<context>
    <name>RecentSurveys</name>
    <message>
        <source>No survey in the list has these words. Search for fewer of them.</source>
        <translation>Listede bu sözcükleri içeren ölçüm yok. Daha az sözcükle arayın.</translation>
    </message>
    <message>
        <source>Nothing has been opened yet. Open a device's folder, or look at the demonstration.</source>
        <translation>Henüz bir şey açılmadı. Bir cihazın klasörünü açın ya da tanıtım ölçümüne bakın.</translation>
    </message>
    <message>
        <source>Search by name, client, folder or year</source>
        <translation>Ad, müşteri, klasör ya da yıla göre ara</translation>
    </message>
</context>
<context>
    <name>RecordingBox</name>
    <message>
        <source>Channel</source>
        <translation>Kanal</translation>
    </message>
    <message>
        <source>Channel {number}</source>
        <translation>Kanal {number}</translation>
    </message>
    <message>
        <source>Choose…</source>
        <translation>Seç…</translation>
    </message>
    <message>
        <source>No file yet: choose one, or drop it here.</source>
        <translation>Henüz dosya yok: seçin ya da buraya bırakın.</translation>
    </message>
    <message>
        <source>{name} and {count} more</source>
        <translation>{name} ve {count} dosya daha</translation>
    </message>
    <message>
        <source>{seconds} s, {rate} Hz</source>
        <translation>{seconds} s, {rate} Hz</translation>
    </message>
</context>
<context>
    <name>RecordingControl</name>
    <message>
        <source>Recorded {time} as {name}</source>
        <translation>{time} kaydedildi: {name}</translation>
    </message>
</context>
<context>
    <name>RecordingEntry</name>
    <message>
        <source>A recording is running. Close again within six seconds to stop it and leave.</source>
        <translation>Kayıt sürüyor. Durdurup çıkmak için altı saniye içinde yeniden kapatın.</translation>
    </message>
    <message>
        <source>Check</source>
        <translation>Denetim</translation>
    </message>
    <message>
        <source>Where recordings are stored</source>
        <translation>Kayıtların saklandığı yer</translation>
    </message>
    <message>
        <source>●  Recording {time}: back to it</source>
        <translation>●  Kayıt sürüyor {time}: sayfasına dön</translation>
    </message>
</context>
<context>
    <name>RecordingForm</name>
    <message>
        <source>Change…</source>
        <translation>Değiştir…</translation>
    </message>
    <message>
        <source>Inner diameter ({unit})</source>
        <translation>İç çap ({unit})</translation>
    </message>
    <message>
        <source>Main Street</source>
        <translation>Cumhuriyet Caddesi</translation>
    </message>
    <message>
        <source>Name</source>
        <translation>Ad</translation>
    </message>
    <message>
        <source>Operator</source>
        <translation>Operatör</translation>
    </message>
    <message>
        <source>Places on the way</source>
        <translation>Yoldaki yerler</translation>
    </message>
    <message>
        <source>Places the device will pass, one a line: name = distance from the launch</source>
        <translation>Cihazın geçeceği yerler, her satıra bir tane: ad = bırakma noktasından uzaklık</translation>
    </message>
    <message>
        <source>Planned time (min)</source>
        <translation>Planlanan süre (dk)</translation>
    </message>
    <message>
        <source>Rolling radius ({unit})</source>
        <translation>Yuvarlanma yarıçapı ({unit})</translation>
    </message>
    <message>
        <source>Stored in</source>
        <translation>Saklandığı yer</translation>
    </message>
    <message>
        <source>The device is</source>
        <translation>Cihaz</translation>
    </message>
    <message>
        <source>unknown</source>
        <translation>bilinmiyor</translation>
    </message>
    <message>
        <source>valve 12 = 120.5
hydrant 3 = 240</source>
        <translation>vana 12 = 120,5
hidrant 3 = 240</translation>
    </message>
</context>
<context>
    <name>RecordingMarkers</name>
    <message>
        <source>marker {number}</source>
        <translation>işaret {number}</translation>
    </message>
    <message>
        <source>{name} at {time}: what is it?</source>
        <translation>{name}, {time}: burası neresi?</translation>
    </message>
</context>
<context>
    <name>RecordingPage</name>
    <message>
        <source>IMU</source>
        <translation>IMU</translation>
    </message>
    <message>
        <source>Markers</source>
        <translation>İşaretler</translation>
    </message>
    <message>
        <source>Messages</source>
        <translation>İletiler</translation>
    </message>
    <message>
        <source>Process now</source>
        <translation>Şimdi işle</translation>
    </message>
    <message>
        <source>Record another</source>
        <translation>Yeni kayıt</translation>
    </message>
    <message>
        <source>Set-up</source>
        <translation>Hazırlık</translation>
    </message>
    <message>
        <source>Sound</source>
        <translation>Ses</translation>
    </message>
    <message>
        <source>force</source>
        <translation>kuvvet</translation>
    </message>
    <message>
        <source>turn rate</source>
        <translation>dönme hızı</translation>
    </message>
</context>
<context>
    <name>RecordingPanel</name>
    <message>
        <source>Closing
the files …</source>
        <translation>Dosyalar
kapatılıyor …</translation>
    </message>
    <message>
        <source>F5; to stop, press twice within three seconds</source>
        <translation>F5; durdurmak için üç saniye içinde iki kez basın</translation>
    </message>
    <message>
        <source>IMU lost: {count}</source>
        <translation>IMU kaybı: {count}</translation>
    </message>
    <message>
        <source>bad sums: {count}</source>
        <translation>bozuk ileti: {count}</translation>
    </message>
    <message>
        <source>battery {part} %</source>
        <translation>pil %{part}</translation>
    </message>
    <message>
        <source>disc: {hours} h left</source>
        <translation>disk: {hours} saat kaldı</translation>
    </message>
    <message>
        <source>disc: {size} GB free</source>
        <translation>disk: {size} GB boş</translation>
    </message>
    <message>
        <source>gaps: {count}</source>
        <translation>boşluk: {count}</translation>
    </message>
    <message>
        <source>garbage: {count} B</source>
        <translation>anlaşılmayan: {count} B</translation>
    </message>
    <message>
        <source>not drawn: {count}</source>
        <translation>çizilmeyen: {count}</translation>
    </message>
    <message>
        <source>repeated: {count}</source>
        <translation>yinelenen: {count}</translation>
    </message>
    <message>
        <source>restarts: {count}</source>
        <translation>yeniden başlama: {count}</translation>
    </message>
    <message>
        <source>sound lost: {seconds} s</source>
        <translation>ses kaybı: {seconds} s</translation>
    </message>
    <message>
        <source>■  Once more
to stop</source>
        <translation>■  Durdurmak için
bir daha</translation>
    </message>
    <message>
        <source>■  Stop
(press twice)</source>
        <translation>■  Durdur
(iki kez basın)</translation>
    </message>
    <message>
        <source>○ not recording</source>
        <translation>○ kayıt yok</translation>
    </message>
    <message>
        <source>○ on disc: …</source>
        <translation>○ diske yazma: …</translation>
    </message>
    <message>
        <source>●  Record</source>
        <translation>●  Kayıt</translation>
    </message>
    <message>
        <source>⚠ battery {part} %: plug in</source>
        <translation>⚠ pil %{part}: fişe takın</translation>
    </message>
    <message>
        <source>⚠ disc: {hours} h left</source>
        <translation>⚠ disk: {hours} saat kaldı</translation>
    </message>
    <message>
        <source>⚠ on disc: {age} s late</source>
        <translation>⚠ disk {age} s geride</translation>
    </message>
    <message>
        <source>⚡ mains, {part} %</source>
        <translation>⚡ şebeke, %{part}</translation>
    </message>
    <message>
        <source>✓ on disc</source>
        <translation>✓ diskte</translation>
    </message>
</context>
<context>
    <name>RecordingWords</name>
    <message>
        <source>alive</source>
        <translation>çalışıyor</translation>
    </message>
    <message>
        <source>closed</source>
        <translation>kapalı</translation>
    </message>
    <message>
        <source>input lost</source>
        <translation>giriş koptu</translation>
    </message>
    <message>
        <source>no signal</source>
        <translation>sinyal yok</translation>
    </message>
    <message>
        <source>not chosen</source>
        <translation>seçilmedi</translation>
    </message>
    <message>
        <source>waiting for it</source>
        <translation>bekleniyor</translation>
    </message>
</context>
<context>
    <name>RepeatControl</name>
    <message>
        <source>Another run of this pipe</source>
        <translation>Bu hattın başka bir ölçümü</translation>
    </message>
    <message>
        <source>Choose another run of this pipe</source>
        <translation>Bu hattın başka bir ölçümünü seçin</translation>
    </message>
    <message>
        <source>Choose another run of this pipe: a recent survey, or its folder.</source>
        <translation>Bu hattın başka bir ölçümünü seçin: son kullanılanlardan birini ya da klasörünü.</translation>
    </message>
    <message>
        <source>Comparing two runs</source>
        <translation>İki ölçüm karşılaştırılıyor</translation>
    </message>
    <message>
        <source>Comparing …</source>
        <translation>Karşılaştırılıyor …</translation>
    </message>
    <message>
        <source>Open and process a survey first, then compare it with another run of its pipe.</source>
        <translation>Önce bir ölçüm açıp işleyin, sonra aynı hattın başka bir ölçümüyle karşılaştırın.</translation>
    </message>
    <message>
        <source>Write the changes</source>
        <translation>Değişiklikleri yaz</translation>
    </message>
    <message>
        <source>Written to {folder}</source>
        <translation>Yazıldı: {folder}</translation>
    </message>
</context>
<context>
    <name>RepeatPage</name>
    <message>
        <source>Back</source>
        <translation>Geri</translation>
    </message>
    <message>
        <source>Change</source>
        <translation>Değişiklik</translation>
    </message>
    <message>
        <source>Choose another run of this pipe</source>
        <translation>Bu hattın başka bir ölçümünü seçin</translation>
    </message>
    <message>
        <source>Choose folder…</source>
        <translation>Klasör seç…</translation>
    </message>
    <message>
        <source>Compare with</source>
        <translation>Karşılaştırılacak ölçüm</translation>
    </message>
    <message>
        <source>Go to the leak</source>
        <translation>Kaçağa git</translation>
    </message>
    <message>
        <source>Growth</source>
        <translation>Artış</translation>
    </message>
    <message>
        <source>Hear {name}</source>
        <translation>Dinle: {name}</translation>
    </message>
    <message>
        <source>Leak</source>
        <translation>Kaçak</translation>
    </message>
    <message>
        <source>Open that survey</source>
        <translation>O ölçümü aç</translation>
    </message>
    <message>
        <source>Opposite way</source>
        <translation>Ters yön</translation>
    </message>
    <message>
        <source>Other run</source>
        <translation>Öteki ölçüm</translation>
    </message>
    <message>
        <source>Place</source>
        <translation>Yer</translation>
    </message>
    <message>
        <source>Places of both runs</source>
        <translation>İki ölçümdeki yerler</translation>
    </message>
    <message>
        <source>The other run</source>
        <translation>Öteki ölçüm</translation>
    </message>
    <message>
        <source>The other run went through the pipe the other way round</source>
        <translation>Öteki ölçüm hattı ters yönde geçmiş</translation>
    </message>
    <message>
        <source>This run</source>
        <translation>Bu ölçüm</translation>
    </message>
    <message>
        <source>Write table…</source>
        <translation>Tabloyu yaz…</translation>
    </message>
</context>
<context>
    <name>RepeatView</name>
    <message>
        <source>Both runs along the pipe</source>
        <translation>Hat boyunca iki ölçüm</translation>
    </message>
    <message>
        <source>feet of this survey</source>
        <translation>fit (bu ölçüme göre)</translation>
    </message>
    <message>
        <source>metres of this survey</source>
        <translation>metre (bu ölçüme göre)</translation>
    </message>
</context>
<context>
    <name>ReportControl</name>
    <message>
        <source>Coordinate systems</source>
        <translation>Koordinat sistemleri</translation>
    </message>
    <message>
        <source>End the second review first (Ctrl+J): a report tells what was decided in the end.</source>
        <translation>Önce ikinci incelemeyi bitirin (Ctrl+J): rapor sonunda neye karar verildiğini anlatır.</translation>
    </message>
    <message>
        <source>Export</source>
        <translation>Dışa aktar</translation>
    </message>
    <message>
        <source>Export into</source>
        <translation>Dışa aktarılacak klasör</translation>
    </message>
    <message>
        <source>Pages of the report</source>
        <translation>Raporun sayfaları</translation>
    </message>
    <message>
        <source>Written to {folder}</source>
        <translation>Yazıldı: {folder}</translation>
    </message>
    <message>
        <source>a folder that you choose</source>
        <translation>seçeceğiniz bir klasör</translation>
    </message>
</context>
<context>
    <name>ReportPanel</name>
    <message>
        <source>Back to the list</source>
        <translation>Listeye dön</translation>
    </message>
    <message>
        <source>Cancel</source>
        <translation>İptal</translation>
    </message>
    <message>
        <source>Draft: places undecided or unsure: {count}. Each page of the report says so.</source>
        <translation>Taslak: karar verilmemiş ya da kararsız kalınan yer: {count}. Raporun her sayfasında bu yazar.</translation>
    </message>
    <message>
        <source>Export report and files</source>
        <translation>Raporu ve dosyaları dışa aktar</translation>
    </message>
    <message>
        <source>Exports so far</source>
        <translation>Şimdiye kadarki raporlar</translation>
    </message>
    <message>
        <source>Go to the next undecided</source>
        <translation>Karar bekleyene git</translation>
    </message>
    <message>
        <source>Language of the report</source>
        <translation>Raporun dili</translation>
    </message>
    <message>
        <source>Open folder</source>
        <translation>Klasörü aç</translation>
    </message>
    <message>
        <source>Open report</source>
        <translation>Raporu aç</translation>
    </message>
    <message>
        <source>See the pages</source>
        <translation>Sayfaları gör</translation>
    </message>
    <message>
        <source>What will be written</source>
        <translation>Neler yazılacak</translation>
    </message>
</context>
<context>
    <name>ReportWords</name>
    <message>
        <source>Class</source>
        <translation>Sınıf</translation>
    </message>
    <message>
        <source>Left out or cut:</source>
        <translation>Yazılmayan ya da kesilenler:</translation>
    </message>
    <message>
        <source>Length of the path</source>
        <translation>Yolun uzunluğu</translation>
    </message>
    <message>
        <source>No.</source>
        <translation>No.</translation>
    </message>
    <message>
        <source>Note</source>
        <translation>Not</translation>
    </message>
    <message>
        <source>Stretches not assessed, listed in the report: {count}</source>
        <translation>Raporda listelenen, değerlendirilmeyen bölüm: {count}</translation>
    </message>
    <message>
        <source>There is nothing to report yet. Open and process a survey.</source>
        <translation>Henüz raporlanacak bir şey yok. Bir ölçüm açıp işleyin.</translation>
    </message>
    <message>
        <source>These files will be written</source>
        <translation>Yazılacak dosyalar</translation>
    </message>
    <message>
        <source>Verdict</source>
        <translation>Karar</translation>
    </message>
    <message>
        <source>all files, columns and units explained</source>
        <translation>bütün dosyalar, sütunlar ve birimler açıklanır</translation>
    </message>
    <message>
        <source>all of it in one file</source>
        <translation>hepsi tek dosyada</translation>
    </message>
    <message>
        <source>for Google Earth and phones</source>
        <translation>Google Earth ve telefonlar için</translation>
    </message>
    <message>
        <source>leaks, pipe by status and track for QGIS and others</source>
        <translation>QGIS ve benzerleri için kaçaklar, duruma göre boru ve yol</translation>
    </message>
    <message>
        <source>one row a candidate</source>
        <translation>her aday için bir satır</translation>
    </message>
    <message>
        <source>points and path for GPS receivers</source>
        <translation>GPS alıcıları için noktalar ve yol</translation>
    </message>
    <message>
        <source>selection tables for each sound file</source>
        <translation>her ses dosyası için seçim tablosu</translation>
    </message>
    <message>
        <source>settings, versions and file hashes</source>
        <translation>ayarlar, sürümler ve dosyaların parmak izleri</translation>
    </message>
    <message>
        <source>the drawing, leaks as blocks</source>
        <translation>çizim, kaçaklar blok olarak</translation>
    </message>
    <message>
        <source>the path with its accuracy</source>
        <translation>yol ve kesinliği</translation>
    </message>
    <message>
        <source>the report with map, accuracy and one section a leak</source>
        <translation>haritalı rapor: konumların kesinliği ve her kaçak için bir bölüm</translation>
    </message>
    <message>
        <source>the same as Shapefiles</source>
        <translation>aynıları Shapefile olarak</translation>
    </message>
    <message>
        <source>the same for Excel, and the stretches, headings in words</source>
        <translation>aynısı Excel için, bölümlerle; başlıklar sözcüklerle</translation>
    </message>
    <message>
        <source>the same for a map program</source>
        <translation>aynı bilgiler, harita programı için</translation>
    </message>
    <message>
        <source>to</source>
        <translation>Yer:</translation>
    </message>
    <message>
        <source>who decided what when</source>
        <translation>kim, neye, ne zaman karar verdi</translation>
    </message>
    <message>
        <source>{count} files written to {folder}</source>
        <translation>{count} dosya yazıldı: {folder}</translation>
    </message>
</context>
<context>
    <name>ReviewControl</name>
    <message>
        <source>All candidates are decided: go to the report (Ctrl+5)</source>
        <translation>Bütün adaylar için karar verildi: rapora gidin (Ctrl+5)</translation>
    </message>
    <message>
        <source>All candidates are judged: end the second review and compare (Ctrl+J)</source>
        <translation>Bütün adaylar için karar verildi: ikinci incelemeyi bitirip karşılaştırın (Ctrl+J)</translation>
    </message>
    <message>
        <source>Done again: {what}</source>
        <translation>Yinelendi: {what}</translation>
    </message>
    <message>
        <source>Nothing undecided is left in this list; undecided ones that the filter hides: {count}</source>
        <translation>Bu listede karar bekleyen kalmadı; süzgecin gizlediği karar bekleyen: {count}</translation>
    </message>
    <message>
        <source>Undone: {what}</source>
        <translation>Geri alındı: {what}</translation>
    </message>
    <message>
        <source>class of {name}</source>
        <translation>{name} sınıfı</translation>
    </message>
    <message>
        <source>mark by hand</source>
        <translation>elle işaretleme</translation>
    </message>
    <message>
        <source>note on {name}</source>
        <translation>{name} notu</translation>
    </message>
    <message>
        <source>{name}: {verdict}</source>
        <translation>{name}: {verdict}</translation>
    </message>
</context>
<context>
    <name>ReviewPage</name>
    <message>
        <source>Band</source>
        <translation>Bant</translation>
    </message>
    <message>
        <source>Channels</source>
        <translation>Kanallar</translation>
    </message>
    <message>
        <source>Clocks</source>
        <translation>Saatler</translation>
    </message>
    <message>
        <source>E {east}  N {north} {unit}</source>
        <translation>D {east}  K {north} {unit}</translation>
    </message>
    <message>
        <source>Leaks</source>
        <translation>Kaçaklar</translation>
    </message>
    <message>
        <source>Methods</source>
        <translation>Yöntemler</translation>
    </message>
    <message>
        <source>Motion</source>
        <translation>Hareket</translation>
    </message>
    <message>
        <source>Quality</source>
        <translation>Kalite</translation>
    </message>
    <message>
        <source>Spectrum</source>
        <translation>Spektrum</translation>
    </message>
    <message>
        <source>Tie points</source>
        <translation>Bağlama noktaları</translation>
    </message>
    <message>
        <source>Why</source>
        <translation>Neden</translation>
    </message>
</context>
<context>
    <name>ReviewerDialog</name>
    <message>
        <source>A second person judges all candidates without seeing what the first one said. Their verdicts are kept beside the first ones, which stay as they are. Afterwards both are compared.</source>
        <translation>İkinci bir kişi, ilk inceleyenin ne dediğini görmeden tüm adaylar için karar verir. Kararları ilk kararların yanında saklanır; ilk kararlar olduğu gibi kalır. Sonra ikisi karşılaştırılır.</translation>
    </message>
    <message>
        <source>Cancel</source>
        <translation>İptal</translation>
    </message>
    <message>
        <source>Name of the second reviewer</source>
        <translation>İkinci inceleyenin adı</translation>
    </message>
    <message>
        <source>Review blind</source>
        <translation>Kör incelemeye başla</translation>
    </message>
    <message>
        <source>Second reviewer</source>
        <translation>İkinci inceleyen</translation>
    </message>
    <message>
        <source>This is the first reviewer. The second has to be somebody else.</source>
        <translation>Bu, ilk inceleyenin adı. İkinci inceleyen başka biri olmalı.</translation>
    </message>
</context>
<context>
    <name>RouteControl</name>
    <message>
        <source>All files</source>
        <translation>Tüm dosyalar</translation>
    </message>
    <message>
        <source>Import route</source>
        <translation>Güzergâh al</translation>
    </message>
    <message>
        <source>Joining the lines</source>
        <translation>Çizgiler birleştiriliyor</translation>
    </message>
    <message>
        <source>Map files</source>
        <translation>Harita dosyaları</translation>
    </message>
    <message>
        <source>Open a recording first; its route can then be imported.</source>
        <translation>Önce bir kayıt açın; güzergâhı ondan sonra alınabilir.</translation>
    </message>
    <message>
        <source>Reading {name}</source>
        <translation>{name} okunuyor</translation>
    </message>
    <message>
        <source>route</source>
        <translation>güzergâh</translation>
    </message>
</context>
<context>
    <name>RouteDialog</name>
    <message>
        <source>Add what lies between</source>
        <translation>Aradakileri de seç</translation>
    </message>
    <message>
        <source>As in the file: {name}</source>
        <translation>Dosyadaki gibi: {name}</translation>
    </message>
    <message>
        <source>Cancel</source>
        <translation>İptal</translation>
    </message>
    <message>
        <source>Choose also the lines that connect the chosen ones by the shortest way</source>
        <translation>Seçilenleri en kısa yoldan bağlayan çizgileri de seçer</translation>
    </message>
    <message>
        <source>Coordinate system</source>
        <translation>Koordinat sistemi</translation>
    </message>
    <message>
        <source>Cut off what lies before the launch</source>
        <translation>Bırakma noktasından öncesini kes</translation>
    </message>
    <message>
        <source>Direction and accuracy</source>
        <translation>Yön ve doğruluk</translation>
    </message>
    <message>
        <source>Drawing's own metres: the line begins at the launch</source>
        <translation>Çizimin kendi metreleri: çizgi bırakma noktasında başlar</translation>
    </message>
    <message>
        <source>East and north are swapped</source>
        <translation>Doğu ile kuzey yer değiştirmiş</translation>
    </message>
    <message>
        <source>How far the pipe may lie from the line of the map (one standard deviation)</source>
        <translation>Borunun haritadaki çizgiden ne kadar uzakta olabileceği (bir standart sapma)</translation>
    </message>
    <message>
        <source>Import route</source>
        <translation>Güzergâh al</translation>
    </message>
    <message>
        <source>Import route: {file}</source>
        <translation>Güzergâh al: {file}</translation>
    </message>
    <message>
        <source>Join gaps up to ({unit})</source>
        <translation>Birleştirilecek boşluk ({unit})</translation>
    </message>
    <message>
        <source>Lines: tap those that the run followed</source>
        <translation>Çizgiler: geçişin izlediklerine dokunun</translation>
    </message>
    <message>
        <source>Map accuracy ± 1σ ({unit})</source>
        <translation>Harita doğruluğu ± 1σ ({unit})</translation>
    </message>
    <message>
        <source>Metres east and north of the launch</source>
        <translation>Bırakma noktasından doğuya ve kuzeye metre</translation>
    </message>
    <message>
        <source>Route: {length}</source>
        <translation>Güzergâh: {length}</translation>
    </message>
    <message>
        <source>Tap the line that the run followed, in the map or in the list.</source>
        <translation>Haritada ya da listede, geçişin izlediği çizgiye dokunun.</translation>
    </message>
    <message>
        <source>The file does not say its coordinate system: choose it, or the drawing's own metres.</source>
        <translation>Dosya koordinat sistemini söylemiyor: onu ya da çizimin kendi metrelerini seçin.</translation>
    </message>
    <message>
        <source>The numbers are in</source>
        <translation>Sayıların birimi</translation>
    </message>
    <message>
        <source>Turn round</source>
        <translation>Ters çevir</translation>
    </message>
    <message>
        <source>US survey feet</source>
        <translation>ABD ölçme ayağı</translation>
    </message>
    <message>
        <source>Use as route</source>
        <translation>Güzergâh yap</translation>
    </message>
    <message>
        <source>as in the coordinate system</source>
        <translation>koordinat sistemindeki gibi</translation>
    </message>
    <message>
        <source>centimetres</source>
        <translation>santimetre</translation>
    </message>
    <message>
        <source>feet</source>
        <translation>ayak (ft)</translation>
    </message>
    <message>
        <source>inches</source>
        <translation>inç</translation>
    </message>
    <message>
        <source>metres</source>
        <translation>metre</translation>
    </message>
    <message>
        <source>millimetres</source>
        <translation>milimetre</translation>
    </message>
    <message>
        <source>surveyed length {length}, difference {difference}</source>
        <translation>ölçülmüş uzunluk {length}, fark {difference}</translation>
    </message>
    <message>
        <source>{off} from the launch</source>
        <translation>bırakma noktasından {off}</translation>
    </message>
</context>
<context>
    <name>RouteMap</name>
    <message>
        <source>End</source>
        <translation>Son</translation>
    </message>
    <message>
        <source>Lines of the file from above</source>
        <translation>Dosyadaki çizgilerin üstten görünüşü</translation>
    </message>
    <message>
        <source>N</source>
        <translation>K</translation>
    </message>
    <message>
        <source>Start</source>
        <translation>Baş</translation>
    </message>
</context>
<context>
    <name>SecondReview</name>
    <message>
        <source>A colleague's copy of this survey</source>
        <translation>Bu ölçümün iş arkadaşınızdaki kopyası</translation>
    </message>
    <message>
        <source>Cohen's kappa (1: full agreement, 0: as by chance) {kappa}, 95 % interval {low} … {high}.</source>
        <translation>Cohen kappa değeri (1: tam uyum, 0: rastlantı kadar) {kappa}, %95 aralığı {low} … {high}.</translation>
    </message>
    <message>
        <source>Judged by both: {count}, alike: {alike}.</source>
        <translation>İkisinin de karar verdiği: {count}, aynı karar: {alike}.</translation>
    </message>
    <message>
        <source>Left out, as their leak is not at its place here: {count}.</source>
        <translation>Kaçağı burada aynı yerde olmadığı için alınmayan: {count}.</translation>
    </message>
    <message>
        <source>Nobody has reviewed a second time yet. Ctrl+J begins.</source>
        <translation>Henüz ikinci inceleme yapılmadı. Ctrl+J başlatır.</translation>
    </message>
    <message>
        <source>Opinions taken: {count} of {name}.</source>
        <translation>Alınan görüş: {count} ({name}).</translation>
    </message>
    <message>
        <source>Please wait until the work in progress has ended.</source>
        <translation>Lütfen süren işin bitmesini bekleyin.</translation>
    </message>
    <message>
        <source>Reading opinions</source>
        <translation>Görüşler okunuyor</translation>
    </message>
    <message>
        <source>Second review by {name}: the first verdicts are hidden. Ctrl+J ends it.</source>
        <translation>İkinci inceleme: {name}. İlk kararlar gizli. Ctrl+J bitirir.</translation>
    </message>
    <message>
        <source>The second review has ended. Differences: {count}.</source>
        <translation>İkinci inceleme bitti. Farklar: {count}.</translation>
    </message>
    <message>
        <source>With so few leaks this figure says little.</source>
        <translation>Bu kadar az kaçakla bu değer pek bir şey söylemez.</translation>
    </message>
    <message>
        <source>opinions of {name}</source>
        <translation>{name} görüşleri</translation>
    </message>
    <message>
        <source>{name}: first verdict kept</source>
        <translation>{name}: ilk karar kaldı</translation>
    </message>
    <message>
        <source>{name}: second verdict taken</source>
        <translation>{name}: ikinci karar alındı</translation>
    </message>
</context>
<context>
    <name>SectionModel</name>
    <message>
        <source>Layer</source>
        <translation>Katman</translation>
    </message>
    <message>
        <source>Length ({unit})</source>
        <translation>Uzunluk ({unit})</translation>
    </message>
    <message>
        <source>Line</source>
        <translation>Çizgi</translation>
    </message>
    <message>
        <source>Use</source>
        <translation>Kullan</translation>
    </message>
    <message>
        <source>line {number}</source>
        <translation>çizgi {number}</translation>
    </message>
</context>
<context>
    <name>SectionRow</name>
    <message>
        <source>m/s</source>
        <translation>m/s</translation>
    </message>
</context>
<context>
    <name>SectionTable</name>
    <message>
        <source>Lines of the file</source>
        <translation>Dosyadaki çizgiler</translation>
    </message>
</context>
<context>
    <name>SettingsControl</name>
    <message>
        <source>A logo for the report</source>
        <translation>Rapor için logo</translation>
    </message>
    <message>
        <source>Cancel</source>
        <translation>Vazgeç</translation>
    </message>
    <message>
        <source>Please wait until the work in progress has ended.</source>
        <translation>Lütfen süren iş bitene kadar bekleyin.</translation>
    </message>
    <message>
        <source>Reset</source>
        <translation>Sıfırla</translation>
    </message>
    <message>
        <source>Set looks, units and layouts back to what they were at first?</source>
        <translation>Görünüm, birimler ve düzen ilk hâline döndürülsün mü?</translation>
    </message>
    <message>
        <source>The logo could not be copied: {reason}</source>
        <translation>Logo kopyalanamadı: {reason}</translation>
    </message>
    <message>
        <source>The logo's file is not there any more. Please choose it again.</source>
        <translation>Logo dosyası artık yerinde yok. Lütfen yeniden seçin.</translation>
    </message>
    <message>
        <source>This is no PNG, JPEG or SVG picture. Please choose another file.</source>
        <translation>Bu dosya PNG, JPEG ya da SVG resmi değil. Lütfen başka bir dosya seçin.</translation>
    </message>
    <message>
        <source>This picture is too large: at most 5 MB and 6000 pixels a side.</source>
        <translation>Bu resim çok büyük: en çok 5 MB, kenarı en çok 6000 piksel olabilir.</translation>
    </message>
    <message>
        <source>{size}: it will look coarse in print; 350 pixels wide or more is better.</source>
        <translation>{size}: baskıda net çıkmaz; en az 350 piksel genişlik daha iyidir.</translation>
    </message>
    <message>
        <source>{width} × {height} pixels</source>
        <translation>{width} × {height} piksel</translation>
    </message>
</context>
<context>
    <name>SettingsPanel</name>
    <message>
        <source>Back (F7)</source>
        <translation>Geri (F7)</translation>
    </message>
    <message>
        <source>Colours</source>
        <translation>Renkler</translation>
    </message>
    <message>
        <source>Dark</source>
        <translation>Koyu</translation>
    </message>
    <message>
        <source>For the window and the report. Data files always are in metres, with a point.</source>
        <translation>Pencere ve rapor içindir. Veri dosyaları her zaman metre birimiyle ve ondalık noktayla yazılır.</translation>
    </message>
    <message>
        <source>Language</source>
        <translation>Dil</translation>
    </message>
    <message>
        <source>Language of the report</source>
        <translation>Raporun dili</translation>
    </message>
    <message>
        <source>Language, names, company and the list of surveys stay; looks, units and layouts go.</source>
        <translation>Dil, adlar, firma bilgileri ve ölçüm listesi kalır; görünüm, birimler ve düzen ilk hâline döner.</translation>
    </message>
    <message>
        <source>Light</source>
        <translation>Açık</translation>
    </message>
    <message>
        <source>Operator of new surveys</source>
        <translation>Yeni ölçümlerin operatörü</translation>
    </message>
    <message>
        <source>People and report</source>
        <translation>Kişiler ve rapor</translation>
    </message>
    <message>
        <source>Places along the pipe</source>
        <translation>Hat üzerindeki yerler</translation>
    </message>
    <message>
        <source>Quantities</source>
        <translation>Büyüklükler</translation>
    </message>
    <message>
        <source>Reset to defaults</source>
        <translation>Varsayılanlara dön</translation>
    </message>
    <message>
        <source>Second reviewer</source>
        <translation>İkinci inceleyen</translation>
    </message>
    <message>
        <source>Settings</source>
        <translation>Ayarlar</translation>
    </message>
    <message>
        <source>Show the hints again</source>
        <translation>İpuçlarını yeniden göster</translation>
    </message>
    <message>
        <source>Size of letters and buttons</source>
        <translation>Yazı ve düğme boyu</translation>
    </message>
    <message>
        <source>Start afresh</source>
        <translation>Baştan başla</translation>
    </message>
    <message>
        <source>Start anew now</source>
        <translation>Şimdi yeniden başlat</translation>
    </message>
    <message>
        <source>Sun: for outdoors</source>
        <translation>Güneş: açık hava için</translation>
    </message>
    <message>
        <source>The new size takes effect when Leakline starts anew.</source>
        <translation>Yeni boy, Leakline yeniden başlatılınca geçerli olur.</translation>
    </message>
    <message>
        <source>US: ft, in, psi</source>
        <translation>ABD: ft, in, psi</translation>
    </message>
    <message>
        <source>Units</source>
        <translation>Birimler</translation>
    </message>
    <message>
        <source>Window</source>
        <translation>Pencere</translation>
    </message>
    <message>
        <source>as the window</source>
        <translation>pencere diliyle aynı</translation>
    </message>
    <message>
        <source>chainage: 1234.5</source>
        <translation>hat metresi: 1234,5</translation>
    </message>
    <message>
        <source>metric: m, mm, bar</source>
        <translation>metrik: m, mm, bar</translation>
    </message>
    <message>
        <source>stationing: 1+234.5</source>
        <translation>kilometraj: 1+234,5</translation>
    </message>
    <message>
        <source>{percent} %</source>
        <translation>%{percent}</translation>
    </message>
</context>
<context>
    <name>SoundPicture</name>
    <message>
        <source>Hz</source>
        <translation>Hz</translation>
    </message>
    <message>
        <source>No sound: the data page says why</source>
        <translation>Ses yok: nedeni veri sayfasında</translation>
    </message>
    <message>
        <source>auto</source>
        <translation>oto</translation>
    </message>
    <message>
        <source>fixed</source>
        <translation>sabit</translation>
    </message>
    <message>
        <source>{percent} % is too quiet for these colours: K fits them</source>
        <translation>%{percent} kadarı bu renkler için çok kısık: K ayarlar</translation>
    </message>
</context>
<context>
    <name>SpectrogramTools</name>
    <message>
        <source> Hz</source>
        <translation> Hz</translation>
    </message>
    <message>
        <source>Axes, colours</source>
        <translation>Eksen, renk</translation>
    </message>
    <message>
        <source>Choose the colours' range by what is visible</source>
        <translation>Renklerin aralığını görünene göre seçer</translation>
    </message>
    <message>
        <source>Contrast</source>
        <translation>Kontrast</translation>
    </message>
    <message>
        <source>Drag a rectangle to measure it (else Shift and drag)</source>
        <translation>Ölçmek için bir dikdörtgen sürükleyin (yoksa Shift ile sürükleyin)</translation>
    </message>
    <message>
        <source>Frequencies as the ear hears (mel)</source>
        <translation>Frekanslar kulağın duyduğu gibi (mel)</translation>
    </message>
    <message>
        <source>Frequencies by octaves</source>
        <translation>Frekanslar oktavlarla</translation>
    </message>
    <message>
        <source>Frequencies evenly</source>
        <translation>Frekanslar eşit aralıklı</translation>
    </message>
    <message>
        <source>Green colours</source>
        <translation>Yeşil renkler</translation>
    </message>
    <message>
        <source>Grey, for print</source>
        <translation>Gri, baskı için</translation>
    </message>
    <message>
        <source>Leak band</source>
        <translation>Kaçak bandı</translation>
    </message>
    <message>
        <source>Look for leaks in the usual band</source>
        <translation>Kaçakları olağan bantta arar</translation>
    </message>
    <message>
        <source>Lower edge</source>
        <translation>Alt sınır</translation>
    </message>
    <message>
        <source>Metres along the pipe</source>
        <translation>Boru boyunca metre</translation>
    </message>
    <message>
        <source>Red colours</source>
        <translation>Kırmızı renkler</translation>
    </message>
    <message>
        <source>Reset</source>
        <translation>Sıfırla</translation>
    </message>
    <message>
        <source>Select</source>
        <translation>Seç</translation>
    </message>
    <message>
        <source>Upper edge</source>
        <translation>Üst sınır</translation>
    </message>
    <message>
        <source>What is shown</source>
        <translation>Gösterilen</translation>
    </message>
    <message>
        <source>Yellow and blue</source>
        <translation>Sarı ve mavi</translation>
    </message>
    <message>
        <source>over the background</source>
        <translation>arka planın üstü</translation>
    </message>
    <message>
        <source>short events</source>
        <translation>kısa olaylar</translation>
    </message>
    <message>
        <source>steady sounds</source>
        <translation>sürekli sesler</translation>
    </message>
</context>
<context>
    <name>SpectrogramView</name>
    <message>
        <source>Spectrogram</source>
        <translation>Spektrogram</translation>
    </message>
    <message>
        <source>leak band</source>
        <translation>kaçak bandı</translation>
    </message>
    <message>
        <source>{level} dB</source>
        <translation>{level} dB</translation>
    </message>
    <message>
        <source>{level} dB, {over} dB against beside it</source>
        <translation>{level} dB, yanına göre {over} dB</translation>
    </message>
</context>
<context>
    <name>SpectrumControl</name>
    <message>
        <source>A against B over the whole: {level} dB.</source>
        <translation>A, bütününde B'ye göre: {level} dB.</translation>
    </message>
    <message>
        <source>A stands out in {spans}; most, by {level} ± {half} dB, at {hertz}.</source>
        <translation>A'nın öne çıktığı yer: {spans}; en çok {hertz} çevresinde, {level} ± {half} dB.</translation>
    </message>
    <message>
        <source>A was passed at {a}, B at {b}: rolling alone may explain about {level} dB.</source>
        <translation>A'dan {a}, B'den {b} hızla geçildi: yalnızca yuvarlanma yaklaşık {level} dB açıklayabilir.</translation>
    </message>
    <message>
        <source>A − B</source>
        <translation>A − B</translation>
    </message>
    <message>
        <source>In no band does A stand out of B by more than chance and a decibel.</source>
        <translation>A hiçbir bantta B'den rastlantıdan ve bir desibelden fazla ayrılmıyor.</translation>
    </message>
    <message>
        <source>Measuring …</source>
        <translation>Ölçülüyor …</translation>
    </message>
    <message>
        <source>Save spectrum</source>
        <translation>Spektrumu kaydet</translation>
    </message>
    <message>
        <source>Select a stretch in the spectrogram (Shift and drag), then make it A.</source>
        <translation>Spektrogramda bir bölüm seçin (Shift ile sürükleyin), sonra onu A yapın.</translation>
    </message>
    <message>
        <source>Written: {file}</source>
        <translation>Yazıldı: {file}</translation>
    </message>
    <message>
        <source>around A</source>
        <translation>A'nın çevresi</translation>
    </message>
    <message>
        <source>dB</source>
        <translation>dB</translation>
    </message>
    <message>
        <source>{count} multiples of {hertz} Hz in A: a machine, not a leak.</source>
        <translation>A'da {hertz} Hz'in {count} katı var: bir makine, kaçak değil.</translation>
    </message>
    <message>
        <source>{name}: {place}; {seconds} s, {windows} windows</source>
        <translation>{name}: {place}; {seconds} s, {windows} pencere</translation>
    </message>
</context>
<context>
    <name>SpectrumPanel</name>
    <message>
        <source>A: selection</source>
        <translation>A: seçim</translation>
    </message>
    <message>
        <source>Average</source>
        <translation>Ortalama</translation>
    </message>
    <message>
        <source>B: around A</source>
        <translation>B: çevresi</translation>
    </message>
    <message>
        <source>B: selection</source>
        <translation>B: seçim</translation>
    </message>
    <message>
        <source>Difference A − B</source>
        <translation>Fark A − B</translation>
    </message>
    <message>
        <source>Measure the selected stretch as A</source>
        <translation>Seçili bölümü A olarak ölçer</translation>
    </message>
    <message>
        <source>Measure the selected stretch as B</source>
        <translation>Seçili bölümü B olarak ölçer</translation>
    </message>
    <message>
        <source>Measure what lies before and after A as B</source>
        <translation>A'nın öncesini ve sonrasını B olarak ölçer</translation>
    </message>
    <message>
        <source>Same loudness</source>
        <translation>Aynı ses düzeyi</translation>
    </message>
    <message>
        <source>Take off by how much A is louder than B as a whole: compare the shapes</source>
        <translation>A'nın bütünüyle B'den ne kadar yüksek olduğunu çıkarır: biçimleri karşılaştırır</translation>
    </message>
    <message>
        <source>Write the numbers</source>
        <translation>Sayıları yazar</translation>
    </message>
    <message>
        <source>Write the picture</source>
        <translation>Resmi yazar</translation>
    </message>
    <message>
        <source>with knocks (mean)</source>
        <translation>vuruşlarla (ortalama)</translation>
    </message>
    <message>
        <source>without knocks (median)</source>
        <translation>vuruşsuz (ortanca)</translation>
    </message>
</context>
<context>
    <name>SpectrumView</name>
    <message>
        <source>Spectrum</source>
        <translation>Spektrum</translation>
    </message>
</context>
<context>
    <name>StartControl</name>
    <message>
        <source>Looking for the recent surveys</source>
        <translation>Son ölçümler aranıyor</translation>
    </message>
</context>
<context>
    <name>StartPage</name>
    <message>
        <source>Correlator</source>
        <translation>Korelatör</translation>
    </message>
    <message>
        <source>Five hints</source>
        <translation>Beş ipucu</translation>
    </message>
    <message>
        <source>From the folder off the device to a leak on the map, the same day.</source>
        <translation>Cihazdan alınan klasörden haritadaki kaçağa, aynı gün içinde.</translation>
    </message>
    <message>
        <source>Look at the demonstration</source>
        <translation>Tanıtıma bak</translation>
    </message>
    <message>
        <source>Manual</source>
        <translation>Kılavuz</translation>
    </message>
    <message>
        <source>Open the device's folder…</source>
        <translation>Cihazın klasörünü aç…</translation>
    </message>
    <message>
        <source>Recent surveys</source>
        <translation>Son ölçümler</translation>
    </message>
    <message>
        <source>Settings</source>
        <translation>Ayarlar</translation>
    </message>
    <message>
        <source>or drop a folder anywhere on this window</source>
        <translation>ya da bir klasörü bu pencerenin üzerine bırakın</translation>
    </message>
    <message>
        <source>●  Record</source>
        <translation>●  Kayıt</translation>
    </message>
</context>
<context>
    <name>StepBar</name>
    <message>
        <source>More tools</source>
        <translation>Diğer araçlar</translation>
    </message>
    <message>
        <source>Tie points</source>
        <translation>Bağlama</translation>
    </message>
</context>
<context>
    <name>StretchBox</name>
    <message>
        <source>Stretch (seconds of A)</source>
        <translation>Aralık (A'nın saniyeleri)</translation>
    </message>
    <message>
        <source>end</source>
        <translation>son</translation>
    </message>
    <message>
        <source>from</source>
        <translation>başlangıç</translation>
    </message>
    <message>
        <source>to</source>
        <translation>bitiş</translation>
    </message>
</context>
<context>
    <name>StripsView</name>
    <message>
        <source>No motion data: the data page says why</source>
        <translation>Hareket verisi yok: nedeni veri sayfasında</translation>
    </message>
</context>
<context>
    <name>SurveyForm</name>
    <message>
        <source>Channel (from 0)</source>
        <translation>Kanal (0'dan başlar)</translation>
    </message>
    <message>
        <source>Client</source>
        <translation>Müşteri</translation>
    </message>
    <message>
        <source>Clock drift (ppm)</source>
        <translation>Saat sapması (ppm)</translation>
    </message>
    <message>
        <source>Date</source>
        <translation>Tarih</translation>
    </message>
    <message>
        <source>Device and pipe</source>
        <translation>Cihaz ve boru</translation>
    </message>
    <message>
        <source>Elevation ({unit})</source>
        <translation>Yükseklik ({unit})</translation>
    </message>
    <message>
        <source>First heading (° from north)</source>
        <translation>Başlangıç yönü (kuzeyden °)</translation>
    </message>
    <message>
        <source>GRP</source>
        <translation>CTP</translation>
    </message>
    <message>
        <source>Import route…</source>
        <translation>Güzergâh al…</translation>
    </message>
    <message>
        <source>In the pipe during the run: the size of leaks is told with it</source>
        <translation>Geçiş sırasında boruda: kaçakların büyüklüğü bununla söylenir</translation>
    </message>
    <message>
        <source>Inner diameter ({unit})</source>
        <translation>İç çap ({unit})</translation>
    </message>
    <message>
        <source>Joint to joint ({unit})</source>
        <translation>Ekten eke ({unit})</translation>
    </message>
    <message>
        <source>Latitude (°)</source>
        <translation>Enlem (°)</translation>
    </message>
    <message>
        <source>Launch point</source>
        <translation>Bırakma noktası</translation>
    </message>
    <message>
        <source>Leak finder</source>
        <translation>Kaçak arama</translation>
    </message>
    <message>
        <source>Length of one pipe from joint to joint: the bumps then count the way</source>
        <translation>Bir borunun ekten eke boyu: ek yerlerindeki sarsıntılar yolu sayar</translation>
    </message>
    <message>
        <source>Longitude (°)</source>
        <translation>Boylam (°)</translation>
    </message>
    <message>
        <source>Mapped route</source>
        <translation>Haritadaki güzergâh</translation>
    </message>
    <message>
        <source>Method</source>
        <translation>Yöntem</translation>
    </message>
    <message>
        <source>Name</source>
        <translation>Ad</translation>
    </message>
    <message>
        <source>None. With the pipe's line from the map the path cannot leave it.</source>
        <translation>Yok. Borunun haritadaki çizgisi verilirse yol ondan ayrılamaz.</translation>
    </message>
    <message>
        <source>Operator</source>
        <translation>Operatör</translation>
    </message>
    <message>
        <source>Orientation</source>
        <translation>Yönelim</translation>
    </message>
    <message>
        <source>Pipe material</source>
        <translation>Boru malzemesi</translation>
    </message>
    <message>
        <source>Position</source>
        <translation>Konum</translation>
    </message>
    <message>
        <source>Pressure ({unit})</source>
        <translation>Basınç ({unit})</translation>
    </message>
    <message>
        <source>Remove route</source>
        <translation>Güzergâhı kaldır</translation>
    </message>
    <message>
        <source>Rolling radius ({unit})</source>
        <translation>Yuvarlanma yarıçapı ({unit})</translation>
    </message>
    <message>
        <source>Sound</source>
        <translation>Ses</translation>
    </message>
    <message>
        <source>Sound begins at (s)</source>
        <translation>Sesin başlangıcı (s)</translation>
    </message>
    <message>
        <source>Sound preset</source>
        <translation>Ses ön ayarı</translation>
    </message>
    <message>
        <source>Survey</source>
        <translation>Ölçüm</translation>
    </message>
    <message>
        <source>Surveyed length ({unit})</source>
        <translation>Ölçülmüş uzunluk ({unit})</translation>
    </message>
    <message>
        <source>Table of presets…</source>
        <translation>Ön ayar tablosu…</translation>
    </message>
    <message>
        <source>The device is</source>
        <translation>Cihaz</translation>
    </message>
    <message>
        <source>and North (m)</source>
        <translation>ve kuzey (m)</translation>
    </message>
    <message>
        <source>asbestos cement</source>
        <translation>asbestli çimento</translation>
    </message>
    <message>
        <source>automatic</source>
        <translation>otomatik</translation>
    </message>
    <message>
        <source>automatic: {preset}</source>
        <translation>otomatik: {preset}</translation>
    </message>
    <message>
        <source>cast iron</source>
        <translation>pik döküm</translation>
    </message>
    <message>
        <source>concrete</source>
        <translation>beton</translation>
    </message>
    <message>
        <source>ductile iron</source>
        <translation>düktil font</translation>
    </message>
    <message>
        <source>found by itself</source>
        <translation>kendiliğinden bulunur</translation>
    </message>
    <message>
        <source>in the system</source>
        <translation>Koordinat sistemi</translation>
    </message>
    <message>
        <source>local metres</source>
        <translation>yerel metre</translation>
    </message>
    <message>
        <source>needed</source>
        <translation>gerekli</translation>
    </message>
    <message>
        <source>none</source>
        <translation>yok</translation>
    </message>
    <message>
        <source>or East (m)</source>
        <translation>ya da doğu (m)</translation>
    </message>
    <message>
        <source>steel</source>
        <translation>çelik</translation>
    </message>
    <message>
        <source>unknown</source>
        <translation>bilinmiyor</translation>
    </message>
    <message>
        <source>{length}, {count} points, {system}, ± {sigma} (1σ)</source>
        <translation>{length}, {count} nokta, {system}, ± {sigma} (1σ)</translation>
    </message>
</context>
<context>
    <name>TapBox</name>
    <message>
        <source>At metre</source>
        <translation>Şu metrede</translation>
    </message>
    <message>
        <source>Beyond A</source>
        <translation>A'nın ötesi</translation>
    </message>
    <message>
        <source>Beyond B</source>
        <translation>B'nin ötesi</translation>
    </message>
    <message>
        <source>Measure the speed</source>
        <translation>Hızı ölç</translation>
    </message>
    <message>
        <source>Tap on the pipe beyond a sensor, choose that stretch and its peak, and say where you tapped:</source>
        <translation>Bir algılayıcının ötesinde boruya vurun, o aralığı ve tepesini seçip nerede vurduğunuzu belirtin:</translation>
    </message>
</context>
<context>
    <name>TieControl</name>
    <message>
        <source>The path follows the tie points. The leaks in the list still stand where they were.</source>
        <translation>Yol bağlama noktalarını izliyor. Listedeki kaçaklar henüz eski yerlerinde.</translation>
    </message>
    <message>
        <source>back at the launch</source>
        <translation>bırakma noktasına dönüş</translation>
    </message>
    <message>
        <source>mark {number}</source>
        <translation>işaret {number}</translation>
    </message>
    <message>
        <source>tie points</source>
        <translation>bağlama noktaları</translation>
    </message>
</context>
<context>
    <name>TiePointModel</name>
    <message>
        <source>Chainage ({unit})</source>
        <translation>Hat metresi ({unit})</translation>
    </message>
    <message>
        <source>East (m)</source>
        <translation>Doğu (m)</translation>
    </message>
    <message>
        <source>Latitude</source>
        <translation>Enlem</translation>
    </message>
    <message>
        <source>Longitude</source>
        <translation>Boylam</translation>
    </message>
    <message>
        <source>Name</source>
        <translation>Ad</translation>
    </message>
    <message>
        <source>North (m)</source>
        <translation>Kuzey (m)</translation>
    </message>
    <message>
        <source>Time (s)</source>
        <translation>Zaman (s)</translation>
    </message>
    <message>
        <source>Up ({unit})</source>
        <translation>Yukarı ({unit})</translation>
    </message>
    <message>
        <source>Use</source>
        <translation>Kullan</translation>
    </message>
    <message>
        <source>± 1σ ({unit})</source>
        <translation>± 1σ ({unit})</translation>
    </message>
</context>
<context>
    <name>TiePointPanel</name>
    <message>
        <source>Add at cursor</source>
        <translation>İmlece ekle</translation>
    </message>
    <message>
        <source>Declare a closed loop: a tie point at the launch at the end of the run</source>
        <translation>Kapalı döngü: geçişin sonu için bırakma noktasına bir bağlama noktası ekler</translation>
    </message>
    <message>
        <source>Ended where it began</source>
        <translation>Başladığı yerde bitti</translation>
    </message>
    <message>
        <source>Places the device is known to have passed, and when. They carry the accuracy.</source>
        <translation>Cihazın geçtiği bilinen yerler ve geçiş zamanları. Konumların kesinliği bunlara dayanır.</translation>
    </message>
    <message>
        <source>Remove</source>
        <translation>Sil</translation>
    </message>
    <message>
        <source>Tie points</source>
        <translation>Bağlama noktaları</translation>
    </message>
    <message>
        <source>back at the launch</source>
        <translation>bırakma noktasına dönüş</translation>
    </message>
    <message>
        <source>mark {number}</source>
        <translation>işaret {number}</translation>
    </message>
</context>
<context>
    <name>TourBubble</name>
    <message>
        <source>Close</source>
        <translation>Kapat</translation>
    </message>
    <message>
        <source>Done</source>
        <translation>Tamam</translation>
    </message>
    <message>
        <source>Next →</source>
        <translation>İleri →</translation>
    </message>
    <message>
        <source>← Back</source>
        <translation>← Geri</translation>
    </message>
</context>
<context>
    <name>TourControl</name>
    <message>
        <source>Begin here</source>
        <translation>Buradan başlayın</translation>
    </message>
    <message>
        <source>Hand it over</source>
        <translation>Teslim edin</translation>
    </message>
    <message>
        <source>Listen</source>
        <translation>Dinleyin</translation>
    </message>
    <message>
        <source>Nothing is final</source>
        <translation>Hiçbir şey kesin değil</translation>
    </message>
    <message>
        <source>One key is a verdict</source>
        <translation>Bir tuş, bir karar</translation>
    </message>
    <message>
        <source>Open the folder that you copied off the device ({open}), or drop it on the window. To try it first, take the demonstration ({demo}): nothing can be broken there.</source>
        <translation>Cihazdan kopyaladığınız klasörü açın ({open}) ya da pencereye bırakın. Önce denemek isterseniz tanıtım ölçümünü açın ({demo}): orada hiçbir şey bozulmaz.</translation>
    </message>
    <message>
        <source>{confirm} is a leak, {reject} is none, {unsure} is unsure. Each goes on to the next undecided one and is on the disc at once.</source>
        <translation>{confirm} kaçak, {reject} kaçak değil, {unsure} kararsız. Her biri karar bekleyen sonraki adaya geçer ve anında diske yazılır.</translation>
    </message>
    <message>
        <source>{export} writes the report with one dig sheet a leak, and the files for maps. The lights beside the steps say what is missing ({missing}); {help} opens the manual. These hints: {tour}.</source>
        <translation>{export}, her kaçak için bir kazı föyü içeren raporu ve harita dosyalarını yazar. Adımların yanındaki ışıklar neyin eksik olduğunu söyler ({missing}); {help} kılavuzu açar. Bu ipuçları: {tour}.</translation>
    </message>
    <message>
        <source>{play} plays from the cursor. {loop} plays the selected candidate again and again, with two seconds of lead-in. What you see is what you hear.</source>
        <translation>{play} imleçten çalar. {loop} seçili adayı, iki saniye öncesinden başlayarak döngüde çalar. Ne görüyorsanız onu duyarsınız.</translation>
    </message>
    <message>
        <source>{undo} takes back whatever you did, one step after the other, and brings you back to where it was.</source>
        <translation>{undo} ne yaptıysanız adım adım geri alır ve sizi o yere geri götürür.</translation>
    </message>
</context>
<context>
    <name>ViewMenus</name>
    <message>
        <source>Axes, colours</source>
        <translation>Eksen, renk</translation>
    </message>
    <message>
        <source>Contrast and colours</source>
        <translation>Kontrast ve renkler</translation>
    </message>
    <message>
        <source>Measure</source>
        <translation>Ölç</translation>
    </message>
    <message>
        <source>Selection</source>
        <translation>Seçim</translation>
    </message>
    <message>
        <source>View</source>
        <translation>Görünüm</translation>
    </message>
</context>
<context>
    <name>ViewTools</name>
    <message>
        <source>Full screen, and back (F11)</source>
        <translation>Tam ekran ve geri (F11)</translation>
    </message>
    <message>
        <source>Measure: drag in any view (R at the cursor)</source>
        <translation>Ölç: herhangi bir görünümde sürükleyin (R imleçte)</translation>
    </message>
    <message>
        <source>The views follow the playback page by page (H)</source>
        <translation>Görünümler dinlemeyi sayfa sayfa izler (H)</translation>
    </message>
    <message>
        <source>The views follow the playback with the cursor in the middle (H)</source>
        <translation>Görünümler dinlemeyi imleç ortada kalacak biçimde izler (H)</translation>
    </message>
    <message>
        <source>The views stay while it plays (H)</source>
        <translation>Çalarken görünümler yerinde kalır (H)</translation>
    </message>
    <message>
        <source>You have moved the view: it waits until the playback comes by, or H</source>
        <translation>Görünümü kaydırdınız: dinleme buraya gelene ya da H tuşuna basılana dek bekler</translation>
    </message>
</context>
<context>
    <name>Vocabulary</name>
    <message>
        <source>At</source>
        <translation>Yer</translation>
    </message>
    <message>
        <source>At ({unit})</source>
        <translation>Yer ({unit})</translation>
    </message>
    <message>
        <source>air pocket</source>
        <translation>hava cebi</translation>
    </message>
    <message>
        <source>bend</source>
        <translation>dirsek</translation>
    </message>
    <message>
        <source>bump</source>
        <translation>sarsıntı</translation>
    </message>
    <message>
        <source>carried or pulled</source>
        <translation>taşınan ya da çekilen</translation>
    </message>
    <message>
        <source>confirmed</source>
        <translation>onaylandı</translation>
    </message>
    <message>
        <source>good to know</source>
        <translation>bilgi</translation>
    </message>
    <message>
        <source>large</source>
        <translation>büyük</translation>
    </message>
    <message>
        <source>leak</source>
        <translation>kaçak</translation>
    </message>
    <message>
        <source>medium</source>
        <translation>orta</translation>
    </message>
    <message>
        <source>not assessed</source>
        <translation>değerlendirilmedi</translation>
    </message>
    <message>
        <source>on a foot</source>
        <translation>ayağa takılı</translation>
    </message>
    <message>
        <source>please look</source>
        <translation>lütfen bakın</translation>
    </message>
    <message>
        <source>pump</source>
        <translation>pompa</translation>
    </message>
    <message>
        <source>rejected</source>
        <translation>reddedildi</translation>
    </message>
    <message>
        <source>repaired</source>
        <translation>onarıldı</translation>
    </message>
    <message>
        <source>rolling ball</source>
        <translation>yuvarlanan top</translation>
    </message>
    <message>
        <source>small</source>
        <translation>küçük</translation>
    </message>
    <message>
        <source>traffic</source>
        <translation>trafik</translation>
    </message>
    <message>
        <source>undecided</source>
        <translation>karar bekliyor</translation>
    </message>
    <message>
        <source>unknown</source>
        <translation>bilinmiyor</translation>
    </message>
    <message>
        <source>unsure</source>
        <translation>kararsız</translation>
    </message>
    <message>
        <source>valve</source>
        <translation>vana</translation>
    </message>
    <message>
        <source>{percent} %</source>
        <translation>%{percent}</translation>
    </message>
</context>
<context>
    <name>_FilterPanel</name>
    <message>
        <source>By place</source>
        <translation>Yere göre</translation>
    </message>
    <message>
        <source>By score</source>
        <translation>Puana göre</translation>
    </message>
    <message>
        <source>Class</source>
        <translation>Sınıf</translation>
    </message>
    <message>
        <source>Least score</source>
        <translation>En düşük puan</translation>
    </message>
    <message>
        <source>Listen to each on arrival</source>
        <translation>Her adayı gelince dinle</translation>
    </message>
    <message>
        <source>Marks made by hand have no score; a least score never hides them</source>
        <translation>Elle konan işaretlerin puanı yoktur; puan süzgeci onları gizlemez</translation>
    </message>
    <message>
        <source>Order</source>
        <translation>Sıra</translation>
    </message>
    <message>
        <source>Order of the list</source>
        <translation>Listenin sırası</translation>
    </message>
    <message>
        <source>any class</source>
        <translation>her sınıf</translation>
    </message>
</context>
</TS>
